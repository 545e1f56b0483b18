"""Colours of the figures, by the names that `templates/theme.css` gives them: Okabe and Ito's, light and dark.

They can be told apart with every kind of colour vision. `templates/figures.js` looks a name up in the style sheet.
"""

BLUE = "@blue"
VERMILLION = "@vermillion"
GREEN = "@green"
ORANGE = "@orange"
SKY = "@sky"
PURPLE = "@purple"
OLIVE = "@olive"
INK = "@ink"
FAINT = "@faint"
FAULT = "@fault"  # behind curves: where a log is faulty, what white noise stays within
BAND = "@band"
CYCLE = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILLION, OLIVE, INK)

SHIP = BLUE
REFERENCE = ORANGE
SET_POINT = INK
MEASURED = FAINT
EXPECTED = PURPLE
COMMAND = INK
PASSED = GREEN
FAILED = VERMILLION
SOURCES = {"wind": SKY, "drift": GREEN, "hull": ORANGE, "thrusters": BLUE}


def in_turn(k: int) -> str:
    """Colour of a curve by its number; they come again after the last."""
    return CYCLE[k % len(CYCLE)]


def source(name: str, rank: int) -> str:
    """Colour of a source of load; known ones keep theirs from page to page."""
    return SOURCES.get(name, in_turn(rank + 3))


def faded(colour: str, opacity: float) -> str:
    """Make a colour partly transparent; `opacity` from 0 to 1.

    Examples
    --------
    >>> faded(BLUE, 0.2)
    '@blue/0.2'
    """
    return f"{colour}/{opacity:g}"
