"""Regions about predictions that have the truth in 90 % of cases."""

from dataclasses import dataclass

from shipcosim.models.core.parameters import quantity

_NONE = "neutral: not calibrated"


@dataclass(frozen=True, kw_only=True)
class RegionParameters:
    """Sizes of the regions about predictions 10, 30 and 60 s ahead."""

    position_half_width_10: float = quantity(0.0, "m", "radius of 90 % of the places in 10 s", _NONE, minimum=0.0)
    position_half_width_30: float = quantity(0.0, "m", "radius of 90 % of the places in 30 s", _NONE, minimum=0.0)
    position_half_width_60: float = quantity(0.0, "m", "radius of 90 % of the places in 60 s", _NONE, minimum=0.0)
    heading_half_width_10: float = quantity(
        0.0, "rad", "half-width of 90 % of the headings in 10 s", _NONE, minimum=0.0
    )
    heading_half_width_30: float = quantity(
        0.0, "rad", "half-width of 90 % of the headings in 30 s", _NONE, minimum=0.0
    )
    heading_half_width_60: float = quantity(
        0.0, "rad", "half-width of 90 % of the headings in 60 s", _NONE, minimum=0.0
    )

    @property
    def positions(self) -> tuple[float, float, float]:
        """Radii by horizon. [m]"""
        return self.position_half_width_10, self.position_half_width_30, self.position_half_width_60

    @property
    def headings(self) -> tuple[float, float, float]:
        """Half-widths by horizon. [rad]"""
        return self.heading_half_width_10, self.heading_half_width_30, self.heading_half_width_60
