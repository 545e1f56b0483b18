"""At night: the page as a browser shows it."""

import pytest
from report.run.test_page import file


def test_page_is_soon_there(file, shown_at):
    assert any(max(shown_at(file, 1280).seconds()) < 1.0 for _ in range(3))
