"""Pages from templates: what comes from files stays text, and what a template misspells is an error."""

import re

import jinja2
import pytest

from shipcosim.report.theme.pages import _environment, render
from shipcosim.report.theme.views import Fact, Outcome, Page

EVIL = "</script><script>document.title='owned'</script>&amp;\"'"


def page(data):
    """A page whose texts all are hostile."""
    return Page(
        title=EVIL, facts=(Fact(EVIL, EVIL),), outcome=Outcome("passed", EVIL, EVIL), data=data
    )


def test_texts_are_escaped_wherever_they_stand():
    text = render("theme/templates/base.html.jinja", page({EVIL: EVIL}))
    assert "<script>document" not in text
    assert "&lt;/script&gt;&lt;script&gt;document.title" in text


def test_data_comes_through_as_it_was(data_of):
    text = render("theme/templates/base.html.jinja", page({EVIL: [1.5, None, EVIL]}))
    assert data_of(text) == {EVIL: [1.5, None, EVIL]}


def test_number_that_json_does_not_have_is_refused():
    with pytest.raises(ValueError):
        render("theme/templates/base.html.jinja", page({"x": float("nan")}))


def test_name_that_a_template_misspells_is_an_error():
    with pytest.raises(jinja2.UndefinedError, match="titel"):
        _environment().from_string("{{ page.titel }}").render(page=page({}))


def test_page_is_one_file_without_an_address():
    text = render("theme/templates/base.html.jinja", page({}))
    assert not re.findall(r"<(?:link|script|img)[^>]*(?:src|href)=[\"'](?!data:)", text)
