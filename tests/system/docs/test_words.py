"""Pages and code are written plainly: none of the turns of phrase that readers had to read twice, and short sentences.

`python docs/generators/sentences.py` prints the figures of every page. Reports may have somewhat longer sentences.
"""

from statistics import median

import pytest

LONGEST = {"median": 14, "percentile": 24, "sentence": 30}
"""Words of a sentence, of each guide: median, 90th percentile, and the longest one."""
LONGEST_OF_REPORTS = {"median": 18, "percentile": 25, "sentence": 35}
"""The same of each report."""
MESSAGES = {"median": 12, "percentile": 22}
"""The same of all messages; a value in one counts as a word."""
WORDS = 45_000
"""Of all pages that people write, without reports."""


@pytest.fixture(scope="module")
def texts(generator):
    return generator("sentences")


@pytest.fixture(scope="module")
def pages(texts):
    """Text of each page, by its path."""
    return {
        page.relative_to(texts.ROOT).as_posix(): page.read_text(encoding="utf-8")
        for page in texts.pages()
    }


@pytest.fixture(scope="module")
def guides(pages):
    """Pages of docs without the reports."""
    return {
        name: text
        for name, text in pages.items()
        if name.startswith("docs/") and not name.startswith("docs/reports/")
    }


def test_a_turn_of_phrase_is_found(texts):
    """In prose and in tables, and not in code."""
    assert len(texts.turns("What is wrong is said.\n\n| a | it is told |\n")) == 2
    assert texts.turns("```\nis said\n```\n") == []


def test_sentences_are_told_apart(texts):
    text = "One. Two has `a b` words, see ch. 4 of R. Smith. **Three.** Four\n\n- five\n- six\n"
    assert [texts.length(one) for one in texts.sentences(text)] == [1, 10, 1, 1, 1, 1]


def test_a_draw_can_be_repeated_and_has_all_kinds(texts):
    one, again, other = (texts.drawn(50, seed) for seed in (1, 1, 2))
    assert one == again != other
    assert [kind for kind, _, _ in one] == ["docs"] * 17 + ["message"] * 17 + ["docstring"] * 16


def test_pages_have_no_turn_of_phrase_that_must_be_read_twice(texts, pages):
    found = {name: texts.turns(text) for name, text in pages.items()}
    assert {name: turns for name, turns in found.items() if turns} == {}


def test_messages_and_docstrings_have_none_either(texts):
    found = {where: texts.turns(text) for where, text, _ in texts.texts_of_code()}
    assert len(found) > 5000
    assert {where: turns for where, turns in found.items() if turns} == {}


def test_sentences_of_messages_are_short(texts):
    lengths = [texts.length(one) for one in texts.message_sentences()]
    assert len(lengths) > 1000
    assert median(lengths) <= MESSAGES["median"]
    assert texts.percentile(lengths, 0.9) <= MESSAGES["percentile"]


@pytest.mark.parametrize(("folder", "most"), [("docs", LONGEST), ("reports", LONGEST_OF_REPORTS)])
def test_sentences_of_every_page_are_short(texts, pages, folder, most):
    found = {}
    for name, text in pages.items():
        if name.startswith("docs/") and (name.startswith("docs/reports/") == (folder == "reports")):
            lengths = [texts.length(one) for one in texts.sentences(text)]
            page = {
                "median": median(lengths),
                "percentile": texts.percentile(lengths, 0.9),
                "sentence": max(lengths),
            }
            found |= {(name, kind): n for kind, n in page.items() if n > most[kind]}
    assert found == {}


def test_what_people_write_beside_reports_is_short(texts, guides):
    assert sum(map(texts.words, guides.values())) <= WORDS
