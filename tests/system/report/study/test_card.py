"""The card of a study in a notebook."""

from shipcosim.report.notebook.card import card_html
from shipcosim.report.notebook.sweep_card import sweep_card


def test_card_says_what_the_page_says(study_of):
    tables = study_of(2, with_tracks=False)
    card = sweep_card(tables)
    text = card_html(card)
    assert card.outcome.sentence in text and "8 runs" not in card.title
    assert "Summary, 12 of 108 rows" in text and tables.runs["error"].max() in text


def test_card_of_a_study_without_any_value(study_of):
    tables = study_of(1, with_tracks=False)
    tables.runs["error"] = "vessel: no"
    card = sweep_card(tables)
    assert "108 of 108 runs failed" in card.outcome.sentence
    assert "vessel: no" in card_html(card)
