"""Effects that are in no catalogue: a diagnosis must say `unknown`, not the name of the nearest cause.

As in `effects`: a draw gives the hidden shape, an act turns the knobs of ship i at time t. Their sizes at size 1 are
in the draws; those that need motion to show are not used in a stationkeeping log.
"""

import numpy as np

from truth.effects import Answer, Effect, direction, either
from truth.plant import to_body


def draw_periodic_moment(rng, size, place):
    return {
        "moment": size * rng.uniform(60e3, 140e3),
        "period": rng.uniform(100, 300),
        "phase": direction(rng),
    }


def act_periodic_moment(shape, knobs, i, t, ship):
    knobs.moment[i] += shape["moment"] * np.sin(2 * np.pi * t / shape["period"] + shape["phase"])


def draw_ventilation(rng, size, place):
    """Bursts of 10 to 40 s, one about every 90 s, of both units at once."""
    starts = np.cumsum(rng.exponential(60.0, 100) + 30.0) - 250.0
    return {
        "loss": size * rng.uniform(0.5, 0.9),
        "starts": starts,
        "ends": starts + rng.uniform(10, 40, 100),
    }


def act_ventilation(shape, knobs, i, t, ship):
    if np.any((shape["starts"] <= t) & (t < shape["ends"])):
        knobs.thrust[:2, i] *= 1 - shape["loss"]


def draw_compass_deviation(rng, size, place):
    return {
        "most": size * np.radians(rng.uniform(4, 8)),
        "phase": direction(rng),
        "poles": rng.choice((2, 3)),
    }


def act_compass_deviation(shape, knobs, i, t, ship):
    knobs.heading_bias[i] += shape["most"] * np.sin(shape["poles"] * ship.psi[i] + shape["phase"])


def draw_anchor_spring(rng, size, place):
    """A chain from the bow to the ground 25 to 45 m off, slack within 10 m."""
    angle, reach = direction(rng), rng.uniform(25, 45)
    stiffness = size * rng.uniform(80, 200)
    return {
        "x": place[0] + reach * np.cos(angle),
        "y": place[1] + reach * np.sin(angle),
        "stiffness": stiffness,
    }


def act_anchor_spring(shape, knobs, i, t, ship):
    bow = 16.0
    north = shape["x"] - ship.x[i] - bow * np.cos(ship.psi[i])
    east = shape["y"] - ship.y[i] - bow * np.sin(ship.psi[i])
    length = np.hypot(north, east)
    pull = shape["stiffness"] * max(length - 10.0, 0.0) / max(length, 1.0)
    ahead, across = to_body(ship.psi[i], pull * north, pull * east)
    knobs.force_x[i] += ahead
    knobs.force_y[i] += across
    knobs.moment[i] += bow * across


def draw_shoal(rng, size, place):
    """Shallow water somewhere by the track: motion through it costs much more."""
    x, y = np.asarray(place) + rng.normal(0, 5, 2)
    return {"x": x, "y": y, "radius": rng.uniform(8, 14), "damping": size * rng.uniform(40e3, 80e3)}


def act_shoal(shape, knobs, i, t, ship):
    off = np.hypot(ship.x[i] - shape["x"], ship.y[i] - shape["y"]) / shape["radius"]
    knobs.damping[i] += shape["damping"] * np.exp(-0.5 * off**2)


def draw_wind_shadow(rng, size, place):
    """The mast stands in the wind, the hull in the lee of a quay on one side of a line through the place."""
    return {
        "x": place[0],
        "y": place[1],
        "side": direction(rng),
        "lee": min(size * rng.uniform(0.6, 0.9), 1.0),
    }


def act_wind_shadow(shape, knobs, i, t, ship):
    beyond = (ship.x[i] - shape["x"]) * np.cos(shape["side"]) + (ship.y[i] - shape["y"]) * np.sin(
        shape["side"]
    )
    knobs.wind_scale[i] *= 1 - shape["lee"] / (1 + np.exp(-beyond / 1.0))


def draw_passing_ships(rng, size, place):
    """Suction and push of ships that pass: pulses of a minute or two, force and moment both ways."""
    times = np.cumsum(rng.uniform(120, 300, 30)) - 250.0
    return {
        "times": times,
        "widths": rng.uniform(20, 40, 30),
        "forces": size * rng.uniform(2.5e3, 6e3, 30) * rng.choice((-1, 1), 30),
        "moments": size * rng.uniform(40e3, 100e3, 30) * rng.choice((-1, 1), 30),
    }


def act_passing_ships(shape, knobs, i, t, ship):
    off = (t - shape["times"]) / shape["widths"]
    bell = np.exp(-0.5 * off**2)
    knobs.force_y[i] += np.sum(shape["forces"] * bell)
    knobs.moment[i] += np.sum(shape["moments"] * off * bell)


def draw_yaw_rate_scale(rng, size, place):
    return {"scale": 1 + size * either(rng) * rng.uniform(0.15, 0.35)}


def act_yaw_rate_scale(shape, knobs, i, t, ship):
    knobs.rate_scale[i] *= shape["scale"]


def draw_position_scale(rng, size, place):
    return {"scale": 1 + size * either(rng) * rng.uniform(0.08, 0.2)}


def act_position_scale(shape, knobs, i, t, ship):
    knobs.position_scale[i] *= shape["scale"]


def draw_dead_band(rng, size, place):
    """Clutches that slip below some speed: no thrust from slow propellers."""
    return {"azimuth": size * rng.uniform(45, 70), "tunnel": size * rng.uniform(400, 700)}


def act_dead_band(shape, knobs, i, t, ship):
    knobs.thrust[:2, i] *= np.abs(ship.rpm[:2, i]) > shape["azimuth"]
    knobs.thrust[2, i] *= abs(ship.rpm[2, i]) > shape["tunnel"]


def draw_seiche(rng, size, place):
    speed = size * rng.uniform(0.15, 0.3)
    return {
        "speed": speed,
        "to": direction(rng),
        "period": rng.uniform(300, 700),
        "phase": direction(rng),
    }


def act_seiche(shape, knobs, i, t, ship):
    speed = shape["speed"] * np.sin(2 * np.pi * t / shape["period"] + shape["phase"])
    knobs.current_north[i] += speed * np.cos(shape["to"])
    knobs.current_east[i] += speed * np.sin(shape["to"])


def draw_dragged_chain(rng, size, place):
    """A chain dragged over the ground by the stern: friction of one size against the motion, however slow."""
    return {"friction": size * rng.uniform(2e3, 5e3)}


def act_dragged_chain(shape, knobs, i, t, ship):
    ahead, across = ship.u[i], ship.v[i] - 15.0 * ship.r[i]
    share = shape["friction"] / np.hypot(np.hypot(ahead, across), 0.03)
    knobs.force_x[i] -= share * ahead
    knobs.force_y[i] -= share * across
    knobs.moment[i] += 15.0 * share * across


ALL = {
    "periodic_moment": (draw_periodic_moment, act_periodic_moment),
    "ventilation": (draw_ventilation, act_ventilation),
    "compass_deviation": (draw_compass_deviation, act_compass_deviation),
    "anchor_spring": (draw_anchor_spring, act_anchor_spring),
    "shoal": (draw_shoal, act_shoal),
    "wind_shadow": (draw_wind_shadow, act_wind_shadow),
    "passing_ships": (draw_passing_ships, act_passing_ships),
    "yaw_rate_scale": (draw_yaw_rate_scale, act_yaw_rate_scale),
    "position_scale": (draw_position_scale, act_position_scale),
    "dead_band": (draw_dead_band, act_dead_band),
    "seiche": (draw_seiche, act_seiche),
    "dragged_chain": (draw_dragged_chain, act_dragged_chain),
}
SHOWS_AT_REST = ("periodic_moment", "ventilation", "passing_ships", "dead_band", "seiche")


def draw_unknown(rng, kind, size, place, name=None):
    """An effect outside the catalogue that such a log can show.

    Parameters
    ----------
    rng : numpy.random.Generator
    kind : str
        Of the log: "trial", "work" or "hold".
    size : float
        Factor on its usual size. [1]
    place : tuple of two floats
        A place on the ship's track. [m]
    name : str, optional
        One of ALL; drawn if not given.

    Returns
    -------
    Effect
        Its answer's cause is "unknown" and its note the name.
    """
    drawn = str(rng.choice(SHOWS_AT_REST if kind == "hold" else tuple(ALL)))
    name = name or drawn
    return Effect(Answer("unknown", None, {}, note=name), ALL[name][0](rng, size, place))


def act_unknown(effect, knobs, i, t, ship, ramp):
    """Turn the knobs; an onset does not apply."""
    ALL[effect.answer.note][1](effect.shape, knobs, i, t, ship)
