"""Pieces of the page as HTML. Every text that comes from a file is escaped here."""

import math
from html import escape

from shipcosim.report.theme import palette

WEATHER_COLOURS = {"wind": palette.SKY, "current": palette.BLUE, "waves": palette.GREEN}


def title_of(scenario, system):
    """What the page calls the run."""
    if scenario is not None and (scenario.description or scenario.name):
        return scenario.description or scenario.name
    return f"Simulation of {system.name}" if system is not None and getattr(system, "name", "") else "Simulation"


def header(table, scenario, system, outcome):
    """Title, facts and verdict."""
    facts = []
    if scenario is not None:
        ship = ", ".join(scenario.parameters)
        facts = [("Ship", ship), ("System", scenario.system), ("Scenario", scenario.name)]
    time = table["time"].values
    if len(time):
        facts.append(("Simulated", f"{time[-1] - time[0]:g} s"))
    for name, unit in (("step_size", " s"), ("engine", "")):
        if name in table.attrs:
            facts.append((name.replace("_", " ").capitalize(), f"{table.attrs[name]}{unit}"))
    rows = " ".join(f"<span><b>{escape(k)}</b> {escape(str(v))}</span>" for k, v in facts if v)
    return (
        f"<div><h1>{escape(title_of(scenario, system))}</h1><p class='facts'>{rows}</p></div>"
        f"<div id='verdict' class='verdict {outcome.kind}'><strong>{outcome.word}</strong>"
        f"<span>{escape(outcome.sentence)}</span></div>"
    )


def remarks(sentences):
    """What must not be overlooked, in a box."""
    items = "".join(f"<li>{escape(s)}</li>" for s in sentences)
    return f"<ul id='remarks' class='remarks'>{items}</ul>" if items else ""


def navigation(sections, has_chart):
    """Links to the parts of the page."""
    titles = [("chart", "Track")] * has_chart
    titles += [(f"section-{k}", section.title) for k, section in enumerate(sections)]
    titles += [("choose", "All signals"), ("details", "Parameters")]
    return "".join(f"<a href='#{key}'>{escape(title)}</a>" for key, title in titles)


def chart(there):
    """Place of the track."""
    return "<section id='chart'><h2>Track</h2><div id='track'></div></section>" if there else ""


def weather(flows):
    """Compass rose with an arrow for wind, current and waves, and their sizes."""
    if not flows:
        return ""
    arrows = "".join(_arrow(what, degrees, sense, WEATHER_COLOURS[what]) for what, _, _, degrees, sense in flows)
    rows = "".join(
        f"<tr><td><i style='background:{WEATHER_COLOURS[what]}'></i>{what}</td><td>{size} {unit}</td>"
        f"<td>{sense} {degrees:03.0f}°</td></tr>"
        for what, size, unit, degrees, sense in flows
    )
    points = "".join(
        f"<text x='{55 * math.sin(a):.1f}' y='{-55 * math.cos(a) + 4:.1f}'>{name}</text>"
        for name, a in zip("NESW", (0, math.pi / 2, math.pi, -math.pi / 2), strict=True)
    )
    rose = f"<svg viewBox='-64 -64 128 128' class='rose'><circle r='45'/>{points}{arrows}</svg>"
    return f"<section id='weather'><h2>Weather</h2><div class='weather'>{rose}<table>{rows}</table></div></section>"


def _arrow(what, degrees, sense, colour):
    """Arrow along the flow: wind at the rim, waves nearer the middle, the current outwards from it."""
    tail, tip = {"wind": (-44, -25), "waves": (-23, -4)}.get(what, (6, 43))
    turn = degrees if sense == "from" else degrees + 180
    return (
        f"<g transform='rotate({turn:.1f})' stroke='{colour}' fill='{colour}'>"
        f"<line y1='{tail}' y2='{tip - 8}' stroke-width='4'/><path d='M0 {tip}l-6 -9h12z' stroke='none'/></g>"
    )


def key_figures(figures):
    """Figures to compare runs by."""
    rows = "".join(f"<tr><td>{escape(name)}</td><td>{escape(text)}</td></tr>" for name, text in figures)
    return f"<section id='figures'><h2>Key figures</h2><table>{rows}</table></section>" if rows else ""


def expectations(rows):
    """Table of expectations; `rows` as `summary.judged` gives them."""
    if not rows:
        return ""
    head = "<tr><th></th><th>Expected</th><th>During</th><th>Worst</th><th>At</th></tr>"
    body = "".join(
        f"<tr class='{'passed' if passed else 'failed'}'><td class='word'>{'✓ pass' if passed else '✗ FAIL'}</td>"
        + "".join(f"<td>{escape(text)}</td>" for text in texts)
        + "</tr>"
        for passed, *texts in rows
    )
    return (
        f"<section id='expectations'><h2>Expectations</h2><table><thead>{head}</thead>"
        f"<tbody>{body}</tbody></table></section>"
    )


def sections(made):
    """Places of the panels, numbered through the page."""
    text, number = "", 0
    for k, section in enumerate(made):
        places = "".join(f"<div class='panel' id='panel-{number + n}'></div>" for n in range(len(section.panels)))
        number += len(section.panels)
        text += (
            f"<section id='section-{k}'><h2>{escape(section.title)}</h2><div class='panels'>{places}</div></section>"
        )
    return text


def thinning(span, rows, drawn):
    """What is not drawn, said."""
    if span == 1:
        return ""
    return (
        f"<p id='thinning' class='note'>Drawn are {drawn} of {rows} rows: least and largest value of every "
        f"{span} rows. The files beside this page hold all.</p>"
    )


def details(tables, scenario):
    """Events, start values, versions: to unfold."""
    text = ""
    if scenario is not None and scenario.events:
        text += _fold("events", [(f"{event.time:g} s", _happening(event)) for event in scenario.events])
    if scenario is not None and scenario.set:
        text += _fold("start values of the scenario", scenario.set.items())
    for title, content in tables:
        text += _fold(title.replace("_", " "), content.items())
    return text


def _happening(event):
    changes = [f"{name} = {value}" for name, value in event.override.items()]
    changes += [f"{name} + {value}" for name, value in event.bias.items()]
    return ", ".join(changes + [f"{name} released" for name in event.reset])


def _value(value):
    """A value as text; dictionaries and lists as their items, one after the other."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_value(item)}" for key, item in value.items())
    return ", ".join(map(_value, value)) if isinstance(value, (list, tuple)) else str(value)


def _fold(title, rows):
    body = "".join(f"<tr><td>{escape(str(k))}</td><td>{escape(_value(v))}</td></tr>" for k, v in rows)
    return f"<details><summary>{escape(title[:1].upper() + title[1:])}</summary><table>{body}</table></details>"
