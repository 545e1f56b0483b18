"""Each number of ours on the page beside the thesis stands in the file that its row names."""

import re

import pytest

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
RIVAL = re.compile(r"(?:rival|kinetic) (\d.*)")
LINK = re.compile(r"\]\(([^)#]+)[^)]*\)")


def tables(text):
    """Rows of each table below the first line of heads, by those heads."""
    found = []
    for block in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        head, _, *rows = (
            [cell.strip() for cell in line.strip().strip("|").split("|")]
            for line in block.splitlines()
        )
        found.append((head, rows))
    return found


def missing(cells, text):
    """Numbers of some cells that a text does not hold."""
    numbers = [number for cell in cells for number in NUMBER.findall(cell)]
    return [n for n in numbers if not re.search(rf"(?<![\d.]){re.escape(n)}(?!\.?\d)", text)]


@pytest.fixture(scope="module")
def page(root):
    return root / "docs" / "reports" / "thesis.md"


@pytest.fixture(scope="module")
def results(page):
    """Rows of the five papers, by head."""
    return [
        dict(zip(head, row, strict=True))
        for head, rows in tables(page.read_text("utf-8"))
        for row in rows
        if "printed recipe" in head
    ]


def test_a_number_that_a_file_does_not_hold_is_missed():
    text = "| kinetic | 11.30 (1.2 to 4) | -0.5 % |"
    assert missing(["11.30 m, 4", "-0.5"], text) == []
    assert missing(["1.3", "11.3", "0.56"], text) == ["1.3", "11.3", "0.56"]


def test_each_paper_has_a_table(page, results):
    assert len([head for head, _ in tables(page.read_text("utf-8")) if "file, why" in head]) == 5
    assert len(results) > 50


def test_numbers_of_ours_stand_in_the_file_of_their_row(page, results):
    wrong = []
    for row in results:
        rivals = RIVAL.findall(row["figure"])
        cells = [row["printed recipe"], row["best"], *rivals]
        links = LINK.findall(row["file, why"])
        text = "".join((page.parent / link).read_text("utf-8") for link in links)
        wrong += [(row["figure"], number) for number in missing(cells, text)]
    assert wrong == []


def test_each_file_has_a_command(page, results):
    text = page.read_text("utf-8")
    (commands,) = [rows for head, rows in tables(text) if "command" in head]
    listed = {link for row in commands for link in LINK.findall(row[0])}
    assert {link for row in results for link in LINK.findall(row["file, why"])} <= listed


def test_each_note_of_a_row_is_below_its_table(page):
    for section in page.read_text("utf-8").split("\n## ")[1:]:
        rows = [row for head, rows in tables(section) if "file, why" in head for row in rows]
        asked = {row[-1].split(", ")[-1] for row in rows}
        asked = {note for note in asked if len(note) == 1 and note.isalpha()}
        assert asked == set(re.findall(r"^- \*\*(\w)\.\*\*", section, re.MULTILINE)), section[:40]
