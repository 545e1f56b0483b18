"""Colours of the page: Okabe and Ito's, told apart with every kind of colour vision."""

BLUE, VERMILLION, GREEN, ORANGE = "#0072b2", "#d55e00", "#009e73", "#e69f00"
SKY, PURPLE, OLIVE, INK, PALE = "#56b4e9", "#cc79a7", "#8a7f00", "#1f2933", "#c3cfd9"
CYCLE = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILLION, OLIVE, INK)

SHIP, REFERENCE, SET_POINT, MEASURED, EXPECTED, COMMAND = BLUE, ORANGE, INK, PALE, PURPLE, INK
PASSED, FAILED = GREEN, VERMILLION
SOURCES = {"wind": SKY, "drift": GREEN, "hull": ORANGE, "thrusters": BLUE}


def source(name, rank):
    """Colour of a source of load; known ones keep theirs from page to page."""
    return SOURCES.get(name, CYCLE[(rank + 3) % len(CYCLE)])
