"""Particulars that DNV-ST-0111 Level 1 needs beyond the parameter set: `capability*.toml`."""

from dataclasses import dataclass

from shipcosim.models.core.parameters import quantity, required


@dataclass(frozen=True, kw_only=True)
class HullParticulars:
    """Shape and areas of a hull, `capability.toml`. Midship is half the length between perpendiculars."""

    midship_x: float = required("m", "midship forward of the ship's origin")
    submerged_length: float = required(
        "m", "length under water Los, between foremost and aftmost point", minimum=0.1
    )
    submerged_centre_x: float = required("m", "middle of that length, forward of midship")
    bow_angle: float = required(
        "rad",
        "between centre line and the line from stem to waterline at B/4",
        minimum=0.01,
        maximum=1.6,
    )
    waterplane_aft: float = required(
        "1", "waterplane area behind midship over B Lpp/2", minimum=0.1, maximum=1.5
    )
    wind_area_front: float = required("m2", "area above water, seen from ahead", minimum=0.1)
    wind_area_side: float = required("m2", "area above water, seen from the side", minimum=0.1)
    wind_centre_x: float = required("m", "centre of the side area above water, forward of midship")
    current_area_side: float = required("m2", "area under water, seen from the side", minimum=0.1)
    current_centre_x: float = required(
        "m", "centre of the side area under water, forward of midship"
    )


@dataclass(frozen=True, kw_only=True)
class Hull(HullParticulars):
    """A hull with its main dimensions, which stand in the ship's parameter set. [m]"""

    length: float
    breadth: float
    draught: float


@dataclass(frozen=True, kw_only=True)
class ThrusterParticulars:
    """Particulars of a thruster, `capability-NAME.toml`; its position is a parameter."""

    shaft_height: float = required("m", "propeller's shaft above the base line")
    diameter: float = quantity(
        0.0,
        "m",
        "of the propeller; 0 where the parameter set of the ship has it",
        "neutral",
        minimum=0.0,
    )
    power: float = quantity(
        0.0,
        "W",
        "of the motor; 0 where the parameter set of the ship has it",
        "neutral",
        minimum=0.0,
    )
    thrust_ahead: float = quantity(
        0.0,
        "N",
        "most thrust ahead in a run; 0 where the parameter set has it",
        "neutral",
        minimum=0.0,
    )
    thrust_astern: float = quantity(
        0.0, "N", "most thrust astern, positive; 0 where there is none", "neutral", minimum=0.0
    )
    propeller: str = quantity(
        "open", "1", "open, ducted, contra-rotating or cycloidal; not of a tunnel", "neutral"
    )
    transmission: str = quantity(
        "geared", "1", "geared, pod, rim-driven, shaft or cycloidal", "neutral"
    )
    inlet: str = quantity("other", "1", "of a tunnel: broken, rounded or other", "neutral")
    pitch: str = quantity(
        "fixed",
        "1",
        "fixed or controllable, where a thruster that cannot turn runs astern",
        "neutral",
    )


CHOICES = {
    "propeller": ("open", "ducted", "contra-rotating", "cycloidal"),
    "transmission": ("geared", "pod", "rim-driven", "shaft", "cycloidal"),
    "inlet": ("broken", "rounded", "other"),
    "pitch": ("fixed", "controllable"),
}
"""Allowed words of `ThrusterParticulars`."""
