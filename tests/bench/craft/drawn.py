"""Small and large craft with fixed thrusters, drawn, and their logs, by an own simulation with forces of its own."""

from dataclasses import dataclass, replace
from functools import cache
from math import copysign, cos, exp, pi, sin, sqrt

import numpy as np
from diagnose import usv
from scipy.signal import lfilter

from shipcosim.diagnose.ship.form import form_of
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.series import make_table

GRAVITY = 9.81
STYLES = ("spin", "circles", "straight", "zig-zag", "mixed", "hold")
FAULTS = ("none", "exchanged", "one reversed", "all reversed")
CHANGES = (
    "none",
    "ratio",
    "one weak",
    "late",
    "dead band",
    "weak astern",
    "damping",
    "ratio and damping",
)
SIZES = {
    "ratio": (0.35, 0.5, 2.0),
    "one weak": (0.2, 0.4),
    "late": (3.0, 6.0),  # over the root of length over gravity
    "dead band": (0.25, 0.4),  # of the largest speed
    "weak astern": (0.2, 0.4),
    "damping": (0.35, 2.5),
}
BOTH = (
    (0.5, 0.25),
    (0.4, 0.5),
    (0.6, 2.0),
    (2.0, 3.0),
    (1.8, 0.4),
)  # thrust and damping over the model's


@dataclass(frozen=True)
class Craft:
    """A craft as she is.

    Attributes
    ----------
    length, mass, inertia : float
        [m, kg, kg.m2]
    added : tuple of three floats
        [kg, kg, kg.m2]
    damping : tuple of three pairs of floats
        Linear and quadratic in surge, sway and yaw, positive. [SI]
    power : float
        Of speed in what is quadratic.
    coupled : tuple of float
        Side force and moment over abs(u) v and abs(u) r, and over u r and u v. [SI]
    thrusters : dict of str to tuple of floats
        By name: x, y [m], direction [rad], thrust over squared speed ahead and astern [N.s2], diameter [m].
    advance : float
        Advance ratio without thrust.
    most : float
        Largest speed of the thrusters. [rev/s]
    speed, turn : float
        What she reaches. [m/s, rad/s]
    """

    length: float
    mass: float
    inertia: float
    added: tuple
    damping: tuple
    power: float
    coupled: tuple
    thrusters: dict
    advance: float
    most: float
    speed: float
    turn: float

    @property
    def unit(self):
        """Root of length over gravity. [s]"""
        return sqrt(self.length / GRAVITY)

    @property
    def largest(self):
        """All thrust ahead. [N]"""
        return sum(one[3] for one in self.thrusters.values()) * self.most**2


@dataclass(frozen=True)
class Drawn:
    """A log with its model and what is wrong.

    Attributes
    ----------
    log : xarray.Dataset
    model : ShipModel
    style, fault, change : str
    size : float
        Of the change; of the thrust where damping is another too.
    damping : float
        Of all axes, over what it would be.
    thruster : str
        That a fault or change of one is in.
    craft : Craft
    """

    log: object
    model: object
    style: str
    fault: str
    change: str
    size: float
    thruster: str
    craft: Craft
    damping: float = 1.0


def draw(seed, style=None, fault="none", change="none", rough=0.35):
    """A craft, her model and a log of her.

    Parameters
    ----------
    seed : int
    style, fault, change : str, optional
        Of STYLES, FAULTS, CHANGES.
    rough : float
        Deviation of the natural logarithm by which damping differs from the model's; inertia and thrust by a quarter.
    """
    rng = np.random.default_rng([seed, 22])
    style = style or str(rng.choice(STYLES))
    modelled = _craft(rng)
    real = _real(modelled, rng, rough)
    one = str(rng.choice(list(modelled.thrusters)))
    size = float(rng.choice(SIZES.get(change, (1.0,))))
    damping = size if change == "damping" else 1.0
    if change == "ratio and damping":
        size, damping = BOTH[seed % len(BOTH)]
    log = _log(real, rng, style, change, size, one, damping)
    log = _relabelled(log, fault, one)
    return Drawn(log, _model(modelled), style, fault, change, size, one, real, damping)


def _within(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _craft(rng):
    length = _within(rng, 0.8, 60.0)
    mass = _within(rng, 4.0, 20.0) * length**3
    inertia = mass * (rng.uniform(0.2, 0.32) * length) ** 2
    added = (
        rng.uniform(0.02, 0.2) * mass,
        rng.uniform(0.4, 1.5) * mass,
        rng.uniform(0.2, 1.0) * inertia,
    )
    scale = sqrt(GRAVITY / length)
    thrust, aside = _within(rng, 0.01, 0.4) * mass * GRAVITY, rng.uniform(0.08, 0.3) * length
    speed, turn = rng.uniform(0.2, 0.7) * sqrt(GRAVITY * length), _within(rng, 0.06, 0.4) * scale
    drift = _within(rng, 0.2, 2.0) * (mass + added[1]) * scale * 0.2
    draught = length * rng.uniform(0.03, 0.1)
    across = 0.5 * 1025.0 * rng.uniform(0.5, 1.3) * draught * length
    damping = []
    for load, most in ((thrust, speed), (thrust * aside, turn)):
        linear = rng.uniform(0.2, 0.8)
        damping.append((linear * load / most, (1.0 - linear) * load / most**2))
    damping = (damping[0], (drift, across), damping[1])
    diameter = length * rng.uniform(0.03, 0.08)
    names = {"left": -1.0, "right": 1.0}
    if rng.random() < 0.25:
        names = {f"{end}_{side}": y for end in ("fore", "aft") for side, y in names.items()}
    astern, toe = (
        rng.uniform(0.4, 1.0),
        rng.uniform(-0.5, 0.5) if len(names) > 2 else rng.uniform(-0.05, 0.05),
    )
    each, most = thrust / len(names), speed / (rng.uniform(0.2, 0.7) * diameter)
    units, reach = {}, rng.uniform(0.3, 0.45) * length
    for name, side in names.items():
        x = reach if name.startswith("fore") else -reach
        ahead = each / most**2
        units[name] = (
            x,
            side * aside,
            side * toe * (1.0 if x > 0 else -1.0),
            ahead,
            astern * ahead,
            diameter,
        )
    return Craft(
        length,
        mass,
        inertia,
        added,
        damping,
        1.0,
        (0.0,) * 4,
        units,
        rng.uniform(0.8, 1.5),
        most,
        speed,
        turn,
    )


def _real(craft, rng, rough):
    """The craft as she is: her damping, coupling, inertia and thrust differ from what is modelled."""

    def off(share=1.0):
        return float(np.exp(share * rough * np.clip(rng.standard_normal(), -2.0, 2.0)))

    damping = tuple((one * off(), two * off()) for one, two in craft.damping)
    coupled = (
        abs(rng.normal()) * rough * craft.damping[1][1] * 0.5,
        abs(rng.normal()) * rough * 0.5 * craft.damping[2][0] / craft.speed,
        rng.normal() * 0.3 * rough * craft.mass,
        rng.normal() * 0.3 * rough * craft.added[1],
    )
    inertia = craft.inertia * off(0.25)
    added = tuple(one * off(0.25) for one in craft.added)
    thrust = off(0.25)
    units = {
        name: (x, y, toe, ahead * thrust * off(0.1), astern * thrust * off(0.25), diameter)
        for name, (x, y, toe, ahead, astern, diameter) in craft.thrusters.items()
    }
    power = 1.0 + 0.5 * rough * rng.uniform(-1.0, 1.0)
    own = {
        "damping": damping,
        "coupled": coupled,
        "inertia": inertia,
        "added": added,
        "power": power,
    }
    return replace(craft, thrusters=units, advance=craft.advance * off(0.5), **own)


@cache
def _usv():
    return ship_model_of(usv.structure().checked())


def _model(craft):
    """The model of a craft, of the project's kind."""
    model = _usv()
    hull, unit = model.parts["hull"], model.parts["left"]
    (X_u, X_uu), (Y_v, across), (N_r, N_rr) = craft.damping
    draught = 0.06 * craft.length
    numbers = {
        "mass": craft.mass,
        "inertia_yaw": craft.inertia,
        "length": craft.length,
        "draught": draught,
    }
    numbers |= {
        "breadth": 0.35 * craft.length,
        "A26": 0.0,
        "A62": 0.0,
        "lift": 0.0,
        "N_modrr": -N_rr,
    }
    numbers |= dict(zip(("A11", "A22", "A66"), craft.added, strict=True))
    numbers |= {
        "X_u": -X_u,
        "X_uu": -X_uu,
        "Y_v": -Y_v,
        "N_r": -N_r,
        "cross_flow_drag": 0.0,
        "Y_modvv": -across,
    }
    parts = {
        name: part for name, part in model.parts.items() if not name.startswith(("left", "right"))
    }
    parts["hull"] = replace(hull, **numbers)
    fixed, speed = {}, 60.0 * craft.most
    for name, (x, y, toe, ahead, astern, diameter) in craft.thrusters.items():
        made = replace(unit, x=x, y=y, diameter=diameter, rpm_max=speed, side_force_coefficient=0.0)
        loss = 1.0 - ahead / made.bollard[0]
        astern_loss = 1.0 - astern / (made.bollard[1] * (1.0 - loss))
        parts[name] = replace(made, thrust_loss=loss, reverse_loss=astern_loss)
        parts[form_of(name)] = model.parts[form_of("left")]
        fixed[name] = toe
    wanted = {
        path: size
        for path, size in model.tolerances.items()
        if not path.startswith(("left", "right"))
    }
    return replace(model, parts=parts, fixed=fixed, neighbours={}, tolerances=wanted)


def _log(craft, rng, style, change, size, one, damping):
    """What instruments say of a run."""
    unit = craft.unit
    fine = 0.04 * unit
    every = max(1, round(rng.choice([0.12, 0.3, 0.5]) * unit / fine))
    seconds = _within(rng, 80.0, 700.0) * unit
    time = np.arange(0.0, seconds, fine)
    orders = _orders(rng, style, time, craft)
    weather = _weather(rng, style, time, craft)
    path, told = _sailed(craft, orders, weather, fine, (change, size, one, damping))
    rows = slice(None, None, every)
    x, y, psi, u, v, r = path[rows].T
    noise = rng.standard_normal((6, x.size))
    level = np.exp(rng.uniform(np.log(0.003), np.log(0.03), 4))
    place = level[0] * 2.0 * craft.length
    columns = [
        ("north", x + place * noise[0], "m", ""),
        ("east", y + place * noise[1], "m", ""),
        ("heading", np.degrees(psi + level[1] * 0.5 * noise[2]) % 360.0, "deg", ""),
        ("surge", u + level[2] * craft.speed * noise[3], "m/s", ""),
        ("sway", v + level[2] * craft.speed * noise[4], "m/s", ""),
        ("yaw_rate", np.degrees(r + level[3] * craft.turn * noise[5]), "deg/s", ""),
    ]
    columns += [
        (f"{name}_rpm", 60.0 * told[rows, i], "rpm", "") for i, name in enumerate(craft.thrusters)
    ]
    return make_table(time[rows], columns)


def _levels(rng, time, hold, low=-1.0, high=1.0):
    steps = (time / hold).astype(int)
    return rng.uniform(low, high, steps[-1] + 1)[steps]


def _orders(rng, style, time, craft):
    """Thrust ahead and turning, -1 to 1, or NaN and a heading to keep; (3, n) array: ahead, turn, heading."""
    unit, n = craft.unit, time.size
    hold = rng.uniform(8.0, 40.0) * unit
    ahead, turn, heading = np.zeros(n), np.full(n, np.nan), np.zeros(n)
    if style == "mixed":
        stretch = (time / (rng.uniform(40.0, 100.0) * unit)).astype(int)
        orders = np.zeros((3, n))
        for number in range(stretch[-1] + 1):
            rows = stretch == number
            kind = str(rng.choice(["spin", "circles", "straight", "zig-zag"]))
            orders[:, rows] = _orders(rng, kind, time, craft)[:, rows]
        return orders
    if style == "spin":
        turn = (
            rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 1.0) * (1.0 + 0.3 * _levels(rng, time, hold))
        )
        ahead = np.full(n, rng.uniform(-0.05, 0.05))
    elif style == "circles":
        turn, ahead = (
            _levels(rng, time, 4.0 * hold, -0.6, 0.6),
            _levels(rng, time, 3.0 * hold, 0.2, 0.9),
        )
    elif style == "straight":
        heading, ahead = (
            np.full(n, rng.uniform(0.0, 6.28)),
            _levels(rng, time, 2.0 * hold, 0.1, 1.0),
        )
    elif style == "zig-zag":
        heading = rng.uniform(0.0, 6.28) + np.where(
            (time / hold).astype(int) % 2, -1.0, 1.0
        ) * rng.uniform(0.2, 0.7)
        ahead = np.full(n, rng.uniform(0.3, 0.9))
    else:
        ahead = np.full(n, np.nan)
    return np.stack([ahead, turn, heading])


def _weather(rng, style, time, craft):
    """Loads that nobody knows, (3, n) array: steady, and slowly varying."""
    most = craft.largest
    size = rng.uniform(0.1, 0.4) if style == "hold" else rng.uniform(0.0, 0.08)
    step, found = time[1] - time[0], []
    for load in (most, most, 0.15 * most * craft.length):
        keep = exp(-step / (rng.uniform(6.0, 60.0) * craft.unit))
        slow = lfilter([sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(time.size))
        found.append(size * load * (0.7 * rng.standard_normal() + 0.7 * slow))
    return np.stack(found)


def _sailed(craft, orders, weather, h, change):
    """Motion, (n, 6) array, and what the thrusters are told, (n, k) array [rev/s], step by step."""
    what, size, one, damped = change
    names, units = list(craft.thrusters), list(craft.thrusters.values())
    factor = [
        size if what.startswith("ratio") or (what == "one weak" and name == one) else 1.0
        for name in names
    ]
    delay = int(size * craft.unit / h) if what == "late" else 0
    dead = size * craft.most if what == "dead band" else 0.0
    m11, m22, m66 = (
        craft.mass + craft.added[0],
        craft.mass + craft.added[1],
        craft.inertia + craft.added[2],
    )
    (d1, d2), (e1, e2), (f1, f2) = craft.damping
    c1, c2, c3, c4 = craft.coupled
    path, told = np.zeros((orders.shape[1], 6)), np.zeros((orders.shape[1], len(names)))
    x = y = psi = u = v = r = 0.0
    psi = orders[2, 0]
    sides = [copysign(1.0, one[1]) for one in units]
    for k in range(orders.shape[1]):
        ahead, turn, heading = orders[:, k]
        if turn != turn:
            off = (heading - psi + pi) % (2.0 * pi) - pi
            turn = min(max(2.0 * off - 0.6 * r / craft.turn, -0.7), 0.7)
        if ahead != ahead:
            away = cos(psi) * x + sin(psi) * y
            ahead = min(max(-away / craft.length - 1.5 * u / craft.speed, -0.8), 0.8)
        X, Y, N = weather[:, k]
        c, s = cos(psi), sin(psi)
        X, Y = c * X + s * Y, c * Y - s * X
        for i, (px, py, toe, kf, ka, diameter) in enumerate(units):
            level = min(max(ahead - sides[i] * turn, -1.0), 1.0)
            told[k, i] = craft.most * copysign(sqrt(abs(level)), level)
            n = told[max(k - delay, 0), i]
            if abs(n) < dead:
                continue
            ct, st = cos(toe), sin(toe)
            inflow = ct * (u - py * r) + st * (v + px * r)
            if what == "weak astern" and n < 0.0:
                ka = size * ka
            force = factor[i] * (
                (kf if n > 0.0 else ka) * n * abs(n)
                - kf * abs(n) * inflow / (craft.advance * diameter)
            )
            X, Y, N = X + ct * force, Y + st * force, N + (px * st - py * ct) * force
        U, V, R = abs(u) ** craft.power, abs(v) ** craft.power, abs(r) ** craft.power
        X -= damped * (d1 * u + d2 * U * u * craft.speed ** (1.0 - craft.power))
        Y -= (
            damped * (e1 * v + e2 * V * v * craft.speed ** (1.0 - craft.power))
            + c1 * abs(u) * v
            + c3 * u * r
        )
        N -= (
            damped * (f1 * r + f2 * R * r * craft.turn ** (1.0 - craft.power))
            + c2 * abs(u) * r
            + c4 * u * v
        )
        u_dot = (X + m22 * v * r) / m11
        v_dot = (Y - m11 * u * r) / m22
        r_dot = (N - (m22 - m11) * u * v) / m66
        path[k] = x, y, psi, u, v, r
        u, v, r = u + h * u_dot, v + h * v_dot, r + h * r_dot
        x, y, psi = x + h * (c * u - s * v), y + h * (s * u + c * v), psi + h * r
    return path, told


def _relabelled(log, fault, one):
    """The log with what is wrong of its labels."""
    roles = [str(name) for name in log if str(name).endswith("_rpm")]
    if fault == "exchanged":
        pairs = [(role, role.replace("left", "right")) for role in roles if "left" in role]
        left, right = next(
            (pair for pair in pairs if one.replace("right", "left") in pair[0]), pairs[0]
        )
        return log.assign({left: log[right].copy(), right: log[left].copy()})
    if fault == "one reversed":
        return log.assign({f"{one}_rpm": -log[f"{one}_rpm"]})
    if fault == "all reversed":
        return log.assign({role: -log[role] for role in roles})
    return log
