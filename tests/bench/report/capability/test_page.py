"""At night: the page of a capability says what was computed, how it is to be read, and what it rests on."""

import pytest
from report.capability.test_page import capability, file


def test_page_is_soon_there(file, shown_at):
    assert any(max(shown_at(file, 1280).seconds()) < 1.0 for _ in range(3))
