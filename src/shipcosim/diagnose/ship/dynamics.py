"""Dynamics of the ship model: loads by name, and rates of position, heading and velocity over ground."""

from dataclasses import replace

import numpy as np

from shipcosim.angles import wrap
from shipcosim.diagnose.ship.environment import share_of, swell_of
from shipcosim.diagnose.ship.form import cross_flow_form, form_of, thrust_kept, wind_factors
from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.third_party_fmu import drives_of
from shipcosim.diagnose.ship.thrusters import thruster_loads
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import Arithmetic, cos, sin
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.core.parameters import acts
from shipcosim.models.environment import wind_loads as wind
from shipcosim.models.environment.current import varying_current
from shipcosim.models.environment.earth_fixed_loads import drift_force, earth_force
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.propulsion.tunnel import TunnelParameters
from shipcosim.models.ship.vessel import accelerations

Alike = tuple["ShipModel", dict[str, Load]]
_MADE_OF = {
    "wind": ("wind", "wind_form"),
    "hull_form": ("hull", "hull_form"),
}  # parts that a load is made of
_CURRENT = tuple(f"{of}_{to}" for of in ("current", "trend") for to in ("north", "east"))
_CURRENT += tuple(f"{to}_{at}" for to in ("north", "east") for at in ("start", "end"))


def current_at(time: Arithmetic, model: ShipModel) -> tuple[Arithmetic, Arithmetic]:
    """Velocity of the water towards north and east [m/s] at some times [s]."""
    water = model.parts["water"]
    # Mean current with a linear trend over the log.
    (first, last) = model.span
    share = share_of(time, model.span)
    north = water.current_north + water.trend_north * share
    east = water.current_east + water.trend_east * share
    # A current that varies in speed and direction comes
    # on top, from its values at the first and last row.
    ends = (water.north_start, water.east_start, water.north_end, water.east_end)
    if any(ends):
        speed, to = varying_current(time, *ends, time_start=first, time_end=last)
        return north + speed * cos(to), east + speed * sin(to)
    return north, east


def with_steady_current(model: ShipModel, time: float) -> ShipModel:
    """The ship in the current of a time [s], as one that does not vary."""
    north, east = (float(value) for value in current_at(np.array(time), model))
    steady = dict.fromkeys(_CURRENT, 0.0) | {"current_north": north, "current_east": east}
    return model.with_values({f"water.{name}": value for name, value in steady.items()})


def _body_current(
    psi: Arithmetic, time: Arithmetic, model: ShipModel
) -> tuple[Arithmetic, Arithmetic]:
    """Velocity of the water forward and to starboard. [m/s]"""
    if not any(acts(getattr(model.parts["water"], name)) for name in _CURRENT):
        return 0.0, 0.0
    return to_body(psi, *current_at(time, model))


def loads(
    motion: Motion, inputs: Inputs, model: ShipModel, like: Alike | None = None
) -> dict[str, Load]:
    """Loads on the ship by name: each thruster, wind, wave drift, line.

    Parameters
    ----------
    motion : Motion
    inputs : Inputs
        At the same times.
    model : ShipModel
    like : tuple of ShipModel, dict, optional
        Another ship in the same motion with the same inputs, and her loads: those of equal parts are not computed
        again.

    Returns
    -------
    dict of str to tuple of three arrays
        X, Y, N. [N, N, N.m]
    """
    parts = model.parts
    by_name = {}
    # Loads depend on the velocity through the water.
    u_c, v_c = _body_current(motion.psi, inputs.time, model)
    u_r = motion.u - u_c
    v_r = motion.v - v_c
    r = motion.r
    same = _equal_loads(model, *like) if like else {}

    def kept(name, load):
        """What is left at a hull that takes more of the thrust than modelled."""
        form = parts.get(form_of(name))
        if form is None or not form.acts:
            return load
        share = thrust_kept(*inputs.units[name], u_r, model.length, form)
        return tuple(share * axis for axis in load)

    # Thrusters of this project, then third-party FMUs by
    # their surrogates. Loads of equal parts are taken over.
    for name in [
        name for name in parts if isinstance(parts[name], (AzimuthParameters, TunnelParameters))
    ]:
        by_name[name] = same.get(name) or kept(
            name, thruster_loads(name, inputs, u_r, v_r, r, model)
        )
    for name in model.third_party:
        by_name[name] = same.get(name) or kept(
            name, _third_party_loads(name, motion, inputs, (u_r, v_r), model)
        )
    # Wind, and the deviation of cross-flow drag from the model's form.
    if inputs.wind_speed is not None:
        by_name["wind"] = same.get("wind") or _wind_loads(motion, inputs, model)
    if parts["hull_form"].acts:
        by_name["hull_form"] = same.get("hull_form") or cross_flow_form(
            v_r, r, parts["hull"], parts["hull_form"]
        )
    # Wave drift and a line to the shore, each only where it acts.
    water = parts["water"]
    if np.any(water.drift_north) or np.any(water.drift_east):
        shape = {
            name: getattr(water, f"drift_{name}")
            for name in ("surge_share", "sway_power", "yaw_arm")
        }
        swell = swell_of(inputs.time, model.span, water)
        by_name["drift_force"] = drift_force(
            motion.psi, swell * water.drift_north, swell * water.drift_east, **shape
        )
    if np.any(water.tow_north) or np.any(water.tow_east):
        by_name["earth_force"] = earth_force(
            motion.psi, water.tow_north, water.tow_east, x=water.tow_x
        )
    return by_name


def _equal_loads(model: ShipModel, other: ShipModel, by_name: dict[str, Load]) -> dict[str, Load]:
    """Loads of another ship that this ship has too."""

    def is_equal(name):
        made_of = _MADE_OF.get(name, (name, form_of(name)))
        return all(model.parts.get(part) is other.parts.get(part) for part in made_of)

    # In another current only the wind load is the same, as it does not depend on the water.
    names = by_name if _same_current(model, other) else {"wind"} & set(by_name)
    return {name: by_name[name] for name in names if is_equal(name)}


def _same_current(model: ShipModel, other: ShipModel) -> bool:
    first = model.parts["water"]
    two = other.parts["water"]
    return first is two or all(getattr(first, name) == getattr(two, name) for name in _CURRENT)


def _third_party_loads(
    name: str,
    motion: Motion,
    inputs: Inputs,
    through: tuple[Arithmetic, Arithmetic],
    model: ShipModel,
) -> Load:
    """Load of a third-party FMU by its surrogate, at a velocity through the water."""
    given = motion._asdict() | dict(zip(("u_r", "v_r"), through, strict=True))
    given |= drives_of(*inputs.units.get(name, (0.0, 0.0)))
    return model.third_party[name].built_surrogate.loads(inputs.time, given, model.parts[name])


def _wind_loads(motion: Motion, inputs: Inputs, model: ShipModel) -> Load:
    parameters = model.parts["wind"]
    speed = inputs.wind_speed
    direction = inputs.wind_from
    if speed is None or direction is None:
        raise ValueError("the log has no wind")
    # Wind over ground becomes apparent by the motion of the
    # ship. Wind comes from its direction, hence the signs.
    if model.wind_is_true:
        north = -speed * cos(direction)
        east = -speed * sin(direction)
        speed, direction = wind.apparent_wind(motion.psi, motion.u, motion.v, north, east)
    # Subtract the sensor offset before the load, so that form factors see the true angle.
    angle = wrap(direction - parameters.apparent_wind_offset)
    wind_load = wind.wind_loads(speed, angle, wind=replace(parameters, apparent_wind_offset=0.0))
    form = model.parts["wind_form"]
    if not form.acts:
        return wind_load
    return tuple(
        load * factor for load, factor in zip(wind_load, wind_factors(angle, form), strict=True)
    )


def motion_rates(
    motion: Motion,
    inputs: Inputs,
    model: ShipModel,
    extra: Load = (0.0, 0.0, 0.0),
    like: Alike | None = None,
) -> Motion:
    """Rates of position, heading and velocity over ground.

    Parameters
    ----------
    motion : Motion
    inputs : Inputs
    model : ShipModel
    extra : tuple of three
        Further loads. [N, N, N.m]
    like : tuple of ShipModel, dict, optional
        As for `loads`.

    Returns
    -------
    Motion
        Rates.
    """
    # Kinematics give the rates of position and heading, the equations of motion those of velocity.
    north, east = to_ned(motion.psi, motion.u, motion.v)
    return Motion(north, east, motion.r, *_accelerations(motion, inputs, model, extra, like))


def _accelerations(
    motion: Motion, inputs: Inputs, model: ShipModel, extra: Load, like: Alike | None
) -> Load:
    """Rates of the velocity over ground."""
    # Sum of all loads, and accelerations of the velocity through the water.
    X, Y, N = (
        sum(axis) for axis in zip(extra, *loads(motion, inputs, model, like).values(), strict=True)
    )
    u_c, v_c = _body_current(motion.psi, inputs.time, model)
    u_dot, v_dot, r_dot = accelerations(
        motion.u - u_c, motion.v - v_c, motion.r, X, Y, N, hull=model.parts["hull"]
    )
    # A steady current turns in body axes. Its rate there, (r
    # v_c, -r u_c), is added for the velocity over ground.
    return u_dot + motion.r * v_c, v_dot - motion.r * u_c, r_dot


def rate_difference(
    first: ShipModel, other: ShipModel, motion: Motion, inputs: Inputs, like: Alike
) -> Load:
    """Accelerations of one ship minus those of another in the same motion with the same inputs.

    Parameters
    ----------
    first, other : ShipModel
    motion : Motion
    inputs : Inputs
    like : tuple of ShipModel, dict
        As for `loads`.

    Returns
    -------
    tuple of three arrays
        [m/s2, m/s2, rad/s2]
    """
    # With another hull or current Coriolis force and damping differ too: take the full difference.
    hull = first.parts["hull"]
    if hull is not other.parts["hull"] or not _same_current(first, other):
        rates = (
            _accelerations(motion, inputs, model, (0.0, 0.0, 0.0), like) for model in (first, other)
        )
        return tuple(a - b for a, b in zip(*rates, strict=True))
    # Otherwise only the loads that differ count: M^-1 times their difference.
    mine, theirs = (loads(motion, inputs, model, like) for model in (first, other))
    pairs = [(mine[name], theirs[name]) for name in mine if mine[name] is not theirs[name]]
    X, Y, N = (sum(a[axis] - b[axis] for a, b in pairs) for axis in range(3))
    i11, i22, i26, i62, i66 = hull.inverse_mass
    return i11 * X, i22 * Y + i26 * N, i62 * Y + i66 * N
