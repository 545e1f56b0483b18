"""How long the sentences of the pages and of the messages are, and which turns of phrase they should not have.

`python docs/generators/sentences.py` prints a table: page, words, median and 90th percentile of the length of its
sentences, the longest one, turns of phrase of `PLAIN` that it has. `--show PAGE` prints its longest sentences and these.
`--draw 50 --seed 1` prints fifty random sentences of pages, messages and first lines of docstrings, to be judged.
"""

import argparse
import ast
import random
import re
from collections.abc import Iterator
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parents[2]
END = re.compile(
    r"(?<=[.!?])(?<!e\.g\.)(?<!i\.e\.)(?<!\bch\.)(?<!\bed\.)(?<!\b[A-Z]\.)\*{0,2}\s+(?=[A-Z(`*\"\d])"
)
PLAIN = {
    r"\b(is|are|was|were) said\b(?! to)": "reported, named, or say who says it",
    r"\b(is|are|was|were) told\b": "reported, detected, given",
    r"\bas (it|she) is told\b": "as reported",
    r"\bthat (is|are) none\b": "say what it is instead",
    r"\bwhat (it|she) had\b": "name it",
    r"\bwhat is (told|felt|known|said) of\b": "name it: measured, reported, estimated",
    r"\bis not (heard|asked)\b": "is ignored",
    r"\bby how much\b.{0,60}\bescapes\b": "two sentences",
    r"\bhangs? on the seed": "depends on the seed",
    r"\bspeaks? for\b": "is evidence for",
    r"\b(felt|told) force\b": "measured force",
    r"\bas well as it can be had\b": "as well as possible",
    r"\bif that can be had\b": "if possible",
    r"\bnothing else is the matter\b": "nothing else is wrong",
    r"\bwhere nobody\b": "if no",
    r"\bwhich nobody (had|has) (looked|seen)\b": "unseen",
    r"\b(comes?|came) of it\b": "results",
    r"\bmakes? of (it|them|her)\b": "say what results",
    r"\bit is not believed\b": "it is excluded",
    r"\bgoes with the\b": "is proportional to, or correlates with",
    r"\b(explain|explains|fit|fits) alike\b": "equally well",
    r"\bleaves? something to\b": "say what is missing",
    r"\bput right\b": "corrected",
    r"\bof no use\b": "useless",
    r"\bfor what (it|they) (is|are)\b": "say what happens",
    r"\bat odds with\b": "contradicts",
    r"\bswallows?\b": "is below the resolution",
    r"\bbut for\b": "except",
    r"\bnameless\b": "unmodelled",
    r"\btelegrams?\b": "message",
    r"\bdearer\b": "takes more time",
    r"\bhardly meant\b": "implausible",
    r"\bwhat is to be said\b": "remarks",
    r"\bwhat is felt\b": "the measured force",
    r"\bsails otherwise\b": "sails differently",
}
"""Turns of phrase of ours that readers had to read twice, and what to write instead."""


def pages() -> list[Path]:
    """Pages that people write: README, contributing, changelog, and docs without what is generated."""
    found = [
        ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")
    ]
    found += sorted(
        p for p in (ROOT / "docs").rglob("*.md") if not {"generated", "generators"} & set(p.parts)
    )
    return found


def texts_of_code() -> Iterator[tuple[str, str, bool]]:
    """Strings of four words or more in src: where, text, whether it is a docstring. A value in a message is one word."""
    for file in sorted((ROOT / "src").rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        nodes = list(ast.walk(tree))
        docstrings = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
        parts = {
            id(part) for node in nodes if isinstance(node, ast.JoinedStr) for part in node.values
        }
        for node in nodes:
            if isinstance(node, ast.JoinedStr):
                text = "".join(
                    str(part.value) if isinstance(part, ast.Constant) else "X"
                    for part in node.values
                )
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                text = node.value
            else:
                continue
            if len(text.split()) >= 4 and id(node) not in parts:
                where = f"{file.relative_to(ROOT).as_posix()}:{node.lineno}"
                yield where, text, id(node) in docstrings


def message_sentences() -> list[str]:
    """Sentences of all strings in src that are whole sentences and no docstrings."""
    return [
        one
        for _, text, is_docstring in texts_of_code()
        if not is_docstring and text.rstrip().endswith((".", "?"))
        for one in sentences(text)
    ]


def pool() -> dict[str, list[tuple[str, str]]]:
    """Where each sentence stands, and the sentence, by kind: those of docs, of messages, first ones of docstrings."""
    found: dict[str, list[tuple[str, str]]] = {"docs": [], "message": [], "docstring": []}
    for page in pages():
        if "docs" in page.parts:
            where = page.relative_to(ROOT).as_posix()
            texts = sentences(page.read_text(encoding="utf-8"))
            found["docs"] += [(where, one) for one in texts]
    for where, text, is_docstring in texts_of_code():
        if is_docstring:
            found["docstring"].append((where, " ".join(text.partition("\n\n")[0].split())))
        elif text.rstrip().endswith((".", "?")):
            found["message"] += [(where, one) for one in sentences(text)]
    return found


def drawn(count: int, seed: int) -> list[tuple[str, str, str]]:
    """Random sentences: kind, where, sentence. Each kind has an equal share; the same seed gives the same ones."""
    generator = random.Random(seed)
    chosen = []
    for number, (kind, texts) in enumerate(pool().items()):
        share = count // 3 + (number < count % 3)
        chosen += [(kind, *one) for one in generator.sample(sorted(set(texts)), share)]
    return chosen


def prose(text: str) -> list[str]:
    """Paragraphs and items of lists of a page, without code, tables, headings and pictures."""
    text = re.sub(r"(?ms)^ *```.*?^ *```", "", text)
    text = re.sub(r"(?s)<!--.*?-->", "", text)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"(?m)^(\||#| {4}).*$", "", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"(?m)^\s*([-*]|\d+\.) ", "\n\n", text)
    text = re.sub(r"`[^`\n]*`", lambda match: match[0].replace(" ", "_"), text)
    return [" ".join(part.split()) for part in re.split(r"\n\s*\n", text) if part.strip()]


def sentences(text: str) -> list[str]:
    """Sentences of a page."""
    return [one for part in prose(text) for one in END.split(part) if one]


def length(sentence: str) -> int:
    """Words of a sentence; signs alone are none."""
    return len([word for word in sentence.split() if re.search(r"\w", word)])


def words(text: str) -> int:
    """Words of a whole page, as `wc -w` counts them."""
    return len(text.split())


def turns(text: str) -> list[str]:
    """Turns of phrase that a page should not have, each with the sentence around it."""
    cells = re.findall(r"(?m)^\|.*\|$", text)
    found = []
    for sentence in [*sentences(text), *cells]:
        for pattern, instead in PLAIN.items():
            if match := re.search(pattern, sentence):
                found.append(f"'{match[0]}' ({instead}): {sentence:.160}")
    return found


def percentile(values: list[int], share: float) -> int:
    """The value that `share` of the values do not exceed."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else 0


def main(shown: str = "") -> None:
    """Print the table, or the longest sentences of a page."""
    if shown:
        text = Path(shown).read_text(encoding="utf-8")
        for sentence in sorted(sentences(text), key=length, reverse=True)[:15]:
            print(length(sentence), sentence)
        print(*turns(text), sep="\n")
        return
    everything: list[int] = []
    counted = 0
    print(f"{'page':44} {'words':>6} {'median':>6} {'p90':>4} {'longest':>7} {'turns':>5}")
    for page in pages():
        text = page.read_text(encoding="utf-8")
        lengths = [length(one) for one in sentences(text)]
        everything += lengths
        counted += words(text) if "reports" not in page.parts else 0
        print(
            f"{page.relative_to(ROOT).as_posix():44} {words(text):6} {median(lengths or [0]):6.0f} "
            f"{percentile(lengths, 0.9):4} {max(lengths or [0]):7} {len(turns(text)):5}"
        )
    print(
        f"{'all, words without reports':44} {counted:6} {median(everything):6.0f} "
        f"{percentile(everything, 0.9):4} {max(everything):7}"
    )
    lengths = [length(one) for one in message_sentences()]
    print(f"{'messages':51} {median(lengths):6.0f} {percentile(lengths, 0.9):4} {max(lengths):7}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--show", default="", metavar="PAGE")
    parser.add_argument("--draw", type=int, default=0, metavar="COUNT")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if options.draw:
        for number, (kind, where, sentence) in enumerate(
            drawn(options.draw, options.seed), start=1
        ):
            print(f"{number:3} {kind} {where}\n    {sentence}")
    else:
        main(options.show)
