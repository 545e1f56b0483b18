"""What can be hidden: every cause of the contract, its size drawn at random, and how it acts on the ship.

An effect that is at the ship or its sensors turns knobs; one that is in the log only is applied by `faults`.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np


class Answer(NamedTuple):
    """One hidden cause as the contract names it; parameters in its units and signs."""

    cause: str
    component: str | None
    parameters: dict
    segments: tuple = ()  # (from, to) in s of the log; empty is all of it
    channels: tuple = ()  # roles
    onset: float = 0.0  # s of the log, over 30 s; 0 is there from the start
    note: str = ""  # what an effect outside the catalogue is
    course: str = (
        ""  # "ramp", "spell" or "switching": what it does after its onset; empty: it stays
    )
    spells: tuple = ()  # (from, to) in s: when a spell or a switching effect is there


@dataclass(frozen=True)
class Effect:
    """An answer with what else its law needs and nobody is told."""

    answer: Answer
    shape: dict = field(default_factory=dict)

    def ramp(self, t):
        """How much of the effect is there at a time of the log, 0 to 1."""
        onset = self.answer.onset
        if self.answer.course == "ramp":
            return float(np.clip((t - onset) / (self.answer.spells[0][1] - onset), 0.0, 1.0))
        if self.answer.course:
            rises = (min((t - start) / 30.0, (end - t) / 30.0) for start, end in self.answer.spells)
            return float(np.clip(max(rises), 0.0, 1.0))
        return float(np.clip((t - onset) / 30.0, 0.0, 1.0)) if onset else 1.0


# Least and largest size at size 1, below and above neutral where the two differ; the README shows the same table.
SIZES = {
    "current": (0.12, 0.35, "m/s"),
    "current_varying": (0.15, 0.40, "m/s at its fastest"),
    "wave_drift": (1500.0, 5000.0, "N on the beam"),
    "tow": (1000.0, 4000.0, "N"),
    "wind_scale": (0.15, 0.40, "off 1, either way"),
    "wind_direction": (8.0, 20.0, "deg, either way"),
    "thrust_loss": (0.12, 0.40, ""),
    "azimuth_offset": (4.0, 12.0, "deg, either way"),
    "rpm_offset": (5.0, 15.0, "rpm, either way; tunnel 12 times that"),
    "reverse_loss": (0.20, 0.50, ""),
    "thruster_interaction": (0.20, 0.50, ""),
    "mass": (0.08, 0.20, "off 1, either way"),
    "drag": (0.80, 2.00, "above 1"),
    "crossflow": (0.25, 0.60, "above 1, or 0.6 of that below"),
    "heading_bias": (2.0, 5.0, "deg, either way"),
    "lever_arm": (2.0, 8.0, "m, any direction"),
    "velocity_scale": (0.06, 0.15, "off 1, either way"),
    "navigation_lag": (1.5, 4.0, "s"),
    "thruster_lag": (1.5, 4.0, "s"),
    "clock": (0.12, 0.30, "off 1, either way, in 1 or 2 segments, 400 s together at most"),
    "gap": (25.0, 90.0, "s each, 1 to 3 of them (no size)"),
    "frame": (0.0, 0.0, "(no size)"),
    "channel_swap": (0.0, 0.0, "(no size)"),
    "sign": (0.0, 0.0, "(no size)"),
    "heading_wrap": (1, 4, "samples at each passage through north (no size)"),
}
THRUSTERS = ("port", "starboard", "tunnel")
PHYSICS = tuple(SIZES)[:14]
SENSORS = ("heading_bias", "lever_arm", "velocity_scale")
IN_LOG = (
    "navigation_lag",
    "thruster_lag",
    "clock",
    "gap",
    "frame",
    "channel_swap",
    "sign",
    "heading_wrap",
)
EXCLUSIVE = ({"current", "current_varying"}, set(IN_LOG))  # at most one of each in a pair
NEVER_PAIRED = {"frame", "channel_swap", "sign"}
WITHOUT_ONSET = {"mass", "current_varying"}


def draw_size(cause, rng, size):
    """Size of an effect, above zero, in the unit of SIZES."""
    low, high, _ = SIZES[cause]
    return size * rng.uniform(low, high)


def either(rng):
    """One sign or the other."""
    return rng.choice((-1.0, 1.0))


def vector(length, direction):
    """A vector by north and east as parameters."""
    return {"north": float(length * np.cos(direction)), "east": float(length * np.sin(direction))}


def direction(rng):
    """Any direction. [rad]"""
    return rng.uniform(-np.pi, np.pi)


# --- drawing: (rng, size, minutes) -> component, parameters, shape ----------------------------------------------------


def draw_current(rng, size, minutes):
    return None, vector(draw_size("current", rng, size), direction(rng)), {}


def draw_current_varying(rng, size, minutes):
    """Turning at constant speed by 50 to 140 deg, or growing or dying down in one direction."""
    fastest, first = draw_size("current_varying", rng, size), direction(rng)
    speeds, turn = [fastest, fastest], 0.0
    if rng.random() < 0.5:
        turn = either(rng) * rng.uniform(np.radians(50), np.radians(140))
    else:
        speeds[int(rng.random() < 0.5)] *= rng.uniform(0.0, 0.25)
    start, end = vector(speeds[0], first), vector(speeds[1], first + turn)
    parameters = {f"{k}_start": v for k, v in start.items()} | {
        f"{k}_end": v for k, v in end.items()
    }
    return (
        None,
        parameters,
        {"speeds": tuple(speeds), "first": first, "turn": turn, "last": 60.0 * minutes},
    )


def draw_wave_drift(rng, size, minutes):
    """The shape is that of the ship's table in 4 to 6 s seas, each coefficient off by some 30 %."""
    shape = {
        "surge": 0.33 * (1 + 0.3 * rng.standard_normal()),
        "power": 2.0 + 0.3 * rng.standard_normal(),
        "yaw": 1.6 * (1 + 0.3 * rng.standard_normal()),
        "swell": rng.integers(2**32),
        "swell_time": rng.uniform(60.0, 240.0),
        "last": 60.0 * minutes,
    }
    return None, vector(draw_size("wave_drift", rng, size), direction(rng)), shape


def draw_tow(rng, size, minutes):
    return None, vector(draw_size("tow", rng, size), direction(rng)), {}


def draw_scale(cause):
    def draw(rng, size, minutes):
        return None, {"scale": 1.0 + either(rng) * draw_size(cause, rng, size)}, {}

    return draw


def draw_drag(rng, size, minutes):
    return None, {"scale": 1.0 + draw_size("drag", rng, size)}, {}


def draw_crossflow(rng, size, minutes):
    more = draw_size("crossflow", rng, size)
    return None, {"scale": 1.0 + (more if rng.random() < 0.5 else -0.6 * more)}, {}


def draw_offset(cause):
    def draw(rng, size, minutes):
        return None, {"offset": either(rng) * draw_size(cause, rng, size)}, {}

    return draw


def draw_loss(cause):
    def draw(rng, size, minutes):
        return None, {"loss": draw_size(cause, rng, size)}, {"width": rng.uniform(16.0, 24.0)}

    return draw


def draw_thrust_loss(rng, size, minutes):
    return str(rng.choice(THRUSTERS)), {"loss": draw_size("thrust_loss", rng, size)}, {}


def draw_azimuth_offset(rng, size, minutes):
    return (
        str(rng.choice(THRUSTERS[:2])),
        {"offset": either(rng) * draw_size("azimuth_offset", rng, size)},
        {},
    )


def draw_rpm_offset(rng, size, minutes):
    thruster = str(rng.choice(THRUSTERS))
    offset = (
        either(rng) * draw_size("rpm_offset", rng, size) * (12.0 if thruster == "tunnel" else 1.0)
    )
    return thruster, {"offset": offset}, {}


def draw_lever_arm(rng, size, minutes):
    arm, where = draw_size("lever_arm", rng, size), direction(rng)
    return None, {"x": float(arm * np.cos(where)), "y": float(arm * np.sin(where))}, {}


DRAW = {
    "current": draw_current,
    "current_varying": draw_current_varying,
    "wave_drift": draw_wave_drift,
    "tow": draw_tow,
    "wind_scale": draw_scale("wind_scale"),
    "wind_direction": draw_offset("wind_direction"),
    "thrust_loss": draw_thrust_loss,
    "azimuth_offset": draw_azimuth_offset,
    "rpm_offset": draw_rpm_offset,
    "reverse_loss": draw_loss("reverse_loss"),
    "thruster_interaction": draw_loss("thruster_interaction"),
    "mass": draw_scale("mass"),
    "drag": draw_drag,
    "crossflow": draw_crossflow,
    "heading_bias": draw_offset("heading_bias"),
    "lever_arm": draw_lever_arm,
    "velocity_scale": draw_scale("velocity_scale"),
}


# --- acting: (effect, knobs, i, t, ship, ramp) turns the knobs of ship i at time t of the log -------------------------


def act_current(effect, knobs, i, t, ship, ramp):
    knobs.current_north[i] += ramp * effect.answer.parameters["north"]
    knobs.current_east[i] += ramp * effect.answer.parameters["east"]


def act_current_varying(effect, knobs, i, t, ship, ramp):
    shape = effect.shape
    part = np.clip(t / shape["last"], 0.0, shape.get("goes_to", 1.0))
    speed = shape["speeds"][0] + part * (shape["speeds"][1] - shape["speeds"][0])
    heading = shape["first"] + part * shape["turn"]
    knobs.current_north[i] += speed * np.cos(heading)
    knobs.current_east[i] += speed * np.sin(heading)


def gone_on(effect, last):
    """The effect in a log that goes on until `last`: a current keeps varying at the same pace, all else has no end."""
    if effect.answer.cause != "current_varying":
        return effect
    shape = effect.shape | {"goes_to": last / effect.shape["last"]}
    speed = shape["speeds"][0] + shape["goes_to"] * (shape["speeds"][1] - shape["speeds"][0])
    end = vector(speed, shape["first"] + shape["goes_to"] * shape["turn"])
    parameters = effect.answer.parameters | {
        f"{name}_end": float(value) for name, value in end.items()
    }
    return Effect(effect.answer._replace(parameters=parameters), shape)


def act_wave_drift(effect, knobs, i, t, ship, ramp):
    p, shape = effect.answer.parameters, effect.shape
    beam = ramp * np.hypot(p["north"], p["east"]) * (1 + 0.15 * swell(shape, t))
    towards = np.arctan2(p["east"], p["north"]) - ship.psi[i]
    c, s = np.cos(towards), np.sin(towards)
    knobs.force_x[i] += beam * shape["surge"] * c
    knobs.force_y[i] += beam * np.sign(s) * np.abs(s) ** shape["power"]
    knobs.moment[i] -= beam * shape["yaw"] * 2 * s * c


def swell(shape, t):
    """How the drift swells and ebbs: smooth noise of unit variance through one knot every swell_time."""
    place = (t + 600.0) / shape["swell_time"]
    k = int(place)
    knots = np.random.default_rng(shape["swell"]).standard_normal(k + 2)[k:]
    part = place - k
    a, b = np.cos(np.pi / 2 * part), np.sin(np.pi / 2 * part)
    return a * knots[0] + b * knots[1]


def act_tow(effect, knobs, i, t, ship, ramp):
    knobs.pull_north[i] += ramp * effect.answer.parameters["north"]
    knobs.pull_east[i] += ramp * effect.answer.parameters["east"]


def act_scale(knob):
    def act(effect, knobs, i, t, ship, ramp):
        getattr(knobs, knob)[i] *= 1 + ramp * (effect.answer.parameters["scale"] - 1)

    return act


def act_angle(knob):
    def act(effect, knobs, i, t, ship, ramp):
        getattr(knobs, knob)[i] += ramp * np.radians(effect.answer.parameters["offset"])

    return act


def act_thrust_loss(effect, knobs, i, t, ship, ramp):
    knobs.thrust[THRUSTERS.index(effect.answer.component), i] *= (
        1 - ramp * effect.answer.parameters["loss"]
    )


def act_azimuth_offset(effect, knobs, i, t, ship, ramp):
    unit = THRUSTERS.index(effect.answer.component)
    knobs.azimuth[unit, i] += ramp * np.radians(effect.answer.parameters["offset"])


def act_rpm_offset(effect, knobs, i, t, ship, ramp):
    knobs.rpm[THRUSTERS.index(effect.answer.component), i] += (
        ramp * effect.answer.parameters["offset"]
    )


def act_reverse_loss(effect, knobs, i, t, ship, ramp):
    knobs.reverse_thrust[i] *= 1 - ramp * effect.answer.parameters["loss"]


def act_thruster_interaction(effect, knobs, i, t, ship, ramp):
    knobs.interaction[i] += ramp * effect.answer.parameters["loss"]
    knobs.interaction_width[i] = np.radians(effect.shape["width"])


def act_lever_arm(effect, knobs, i, t, ship, ramp):
    knobs.lever_x[i] += ramp * effect.answer.parameters["x"]
    knobs.lever_y[i] += ramp * effect.answer.parameters["y"]


ACT = {
    "current": act_current,
    "current_varying": act_current_varying,
    "wave_drift": act_wave_drift,
    "tow": act_tow,
    "wind_scale": act_scale("wind_scale"),
    "wind_direction": act_angle("wind_direction"),
    "thrust_loss": act_thrust_loss,
    "azimuth_offset": act_azimuth_offset,
    "rpm_offset": act_rpm_offset,
    "reverse_loss": act_reverse_loss,
    "thruster_interaction": act_thruster_interaction,
    "mass": act_scale("mass"),
    "drag": act_scale("drag"),
    "crossflow": act_scale("crossflow"),
    "heading_bias": act_angle("heading_bias"),
    "lever_arm": act_lever_arm,
    "velocity_scale": act_scale("velocity_scale"),
}
CHANGES_IN_TIME = {"current_varying", "wave_drift"}
