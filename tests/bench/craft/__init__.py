"""Drawn craft of other sizes and forms with gross faults, and what commanded against measured force says of them."""

from craft.drawn import CHANGES, FAULTS, STYLES, Drawn, draw

__all__ = ["CHANGES", "FAULTS", "STYLES", "Drawn", "draw"]
