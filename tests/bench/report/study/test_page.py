"""At night: the page of a study as a browser shows it, and what its views say."""

import pytest
from report.study.test_page import file, large, page, tables


def test_page_is_soon_there(file, shown_at):
    assert any(max(shown_at(file, 1280).seconds()) < 1.5 for _ in range(3))


def test_a_change_of_the_choice_among_tens_of_thousands_is_soon_drawn(large, shown_at):
    page = shown_at(large, 1280)
    assert min(page.ask(SLOWEST) for _ in range(3)) < 0.5, "seconds from a change until it is drawn"


SLOWEST = """
const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
return (async () => {
  let slowest = 0;
  for (const end of [0.5, 1, 2]) {
    const start = performance.now();
    study.setRange("excursion", [0, end]);
    await frame();
    await frame();
    slowest = Math.max(slowest, performance.now() - start);
  }
  return slowest / 1000;
})();
"""
