"""At night: the page of a diagnosis: what it says, and the whole in a browser, light or dark, wide or narrow."""

import pytest
from report.diagnosis.test_page import file, shown


def test_page_is_soon_there(shown):
    assert any(max(shown(1280, "light").seconds()) < 1.0 for _ in range(3))
