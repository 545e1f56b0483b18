"""What is between the ship and her log: errors and lags of her instruments, neutral unless a cause acts."""

from dataclasses import dataclass, fields

from shipcosim.models.core.parameters import quantity


@dataclass(frozen=True)
class Instruments:
    """Errors of the instruments and lags of the log's channels."""

    heading_bias: float = quantity(0.0, "rad", "measured heading minus the true one", "neutral")
    lever_x: float = quantity(0.0, "m", "antenna forward of the origin", "neutral")
    lever_y: float = quantity(0.0, "m", "antenna to starboard of the origin", "neutral")
    velocity_scale: float = quantity(1.0, "1", "logged over true velocity", "neutral")
    navigation_lag: float = quantity(
        0.0, "s", "by how much the navigation's channels are late", "neutral"
    )
    thruster_lag: float = quantity(
        0.0, "s", "by how much the thrusters' channels are late", "neutral"
    )
    order_lag: float = quantity(
        0.0,
        "s",
        "by how much thrusters answer orders later than their models, where a log has orders",
        "neutral",
    )
    wind_lag: float = quantity(
        1.25, "s", "half the time over which the wind sensor averages", "2 to 3 s", tolerance=0.3
    )

    @property
    def errors(self) -> dict[str, float]:
        """All but the lags."""
        return {
            item.name: getattr(self, item.name)
            for item in fields(self)
            if not item.name.endswith("_lag")
        }


LAGS = tuple(
    f"instruments.{item.name}" for item in fields(Instruments) if item.name.endswith("_lag")
)
"""By how much channels are late: paths of these numbers."""
MOUNTING = ("instruments.heading_bias", "instruments.lever_x")
"""What compass and antenna are off, of a log that nobody has checked: paths of these numbers."""
NONLINEAR = frozenset({"instruments.wind_lag"})
"""Numbers whose effect is not linear within their tolerance, in quick gusts: every fit linearises about them again."""
