"""Pieces of the page of a diagnosis as HTML. Every text that comes from a file is escaped here."""

from html import escape

from shipcosim.report.diagnosis.numbers import plain


def header(title, facts):
    """Title, and facts as (name, text)."""
    rows = "".join(f"<span><b>{escape(name)}</b> {escape(str(text))}</span>" for name, text in facts if text)
    return f"<h1>{escape(title)}</h1><p class='facts'>{rows}</p>"


def verdict(kind, word, sentence):
    """The sentence that one reads first."""
    return f"<div class='verdict {escape(kind)}' id='verdict'><b>{escape(word)}</b><p>{escape(sentence)}</p></div>"


def key_figures(figures):
    """Numbers in large print: (number, what it is)."""
    cells = "".join(f"<div class='figure'><b>{escape(n)}</b><span>{escape(text)}</span></div>" for n, text in figures)
    return f"<div class='figures' id='figures'>{cells}</div>" if cells else ""


def next_steps(steps):
    """What to do now."""
    items = "".join(f"<li>{escape(step)}</li>" for step in steps)
    return f"<section class='next' id='next'><h2>What to do next</h2><ul>{items}</ul></section>"


def navigation(links):
    """The links of the chain, each with what it found: (key, title, text)."""
    return "".join(
        f"<a href='#{key}'><b>{number} {escape(title)}</b><span>{escape(text)}</span></a>"
        for number, (key, title, text) in enumerate(links, start=1)
    )


def section(key, heading, *content):
    """A link of the chain."""
    return f"<section id='{key}'><h2>{escape(heading)}</h2>{''.join(content)}</section>"


def lead(text):
    """What a section says, in words."""
    return f"<p class='lead'>{escape(text)}</p>" if text else ""


def listed(texts):
    """Remarks."""
    return f"<ul>{''.join(f'<li>{escape(text)}</li>' for text in texts)}</ul>" if texts else ""


def folded(title, texts):
    """Remarks to unfold."""
    return f"<details><summary>{escape(title)} ({len(texts)})</summary>{listed(texts)}</details>" if texts else ""


def table(head, rows, tight=()):
    """A table that scrolls by itself where it is too wide; columns in `tight` do not wrap."""
    if not rows:
        return ""
    top = "".join(f"<th>{escape(text)}</th>" for text in head)
    body = "".join(
        "<tr>"
        + "".join(f"<td{' class=tight' if i in tight else ''}>{escape(str(cell))}</td>" for i, cell in enumerate(row))
        + "</tr>"
        for row in rows
    )
    return f"<div class='scroll'><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"


def subheading(text):
    """A heading inside a section."""
    return f"<h3>{escape(text)}</h3>"


class Figures:
    """The figures of a page: hands out their places, and keeps what is to be drawn."""

    def __init__(self):
        self.drawn = []

    def grid(self, panels):
        """Places of some figures, two in a row."""
        return f"<div class='panels'>{''.join(self._place(panel) for panel in panels if panel)}</div>"

    def _place(self, panel):
        self.drawn.append({"data": panel["data"], "layout": panel["layout"]})
        unit = f" <small>[{escape(panel['unit'])}]</small>" if panel["unit"] else ""
        caption = f"<figcaption>{escape(panel['note'])}</figcaption>" if panel["note"] else ""
        height = panel["layout"].get("height")
        style = f" style='height:{height}px'" if height else ""
        return (
            f"<figure><h3>{escape(panel['title'])}{unit}</h3>"
            f"<div class='plot' data-figure='{len(self.drawn) - 1}'{style}></div>{caption}</figure>"
        )


def metres(value):
    """A distance as text."""
    return f"{plain(value, 2)} m"
