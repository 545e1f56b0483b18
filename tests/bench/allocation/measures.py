"""What is measured of commands: violations, power, missed load, reversals, time. Limits are those of the ship."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear
from scipy.stats import t as student
from ships import parameters

from allocation.loops import Commanded, loads
from shipcosim.angles import wrap
from shipcosim.models.allocation.power import PowerParameters
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters

AZIMUTH_RATE = np.radians(10.0)  # rad/s: Skulstad 2021, paper V, Table I
SECTOR = np.radians((80.0, 100.0))  # forbidden, to either side: the same
ALMOST = 1e-6  # relative tolerance of limits, for rounding
PUSHING = 1.0  # N
SETTLED = 60.0  # s from the start: reference, observer and thrusters come from rest
CLOSE = 2.0  # N, a moment counted by the ship's yaw lever
TURNING = 200.0  # N: a propeller has reversed when its thrust goes from beyond this to beyond it on the other side


@dataclass(frozen=True)
class Spread:
    """A mean over seeds with its 95 % confidence interval (Student's t), and the largest value of a seed."""

    mean: float
    half: float
    largest: float


def spread(values) -> Spread:
    """Mean, half width of the 95 % interval of the mean, and largest value, of one value a seed."""
    values = np.asarray(values, float)
    n = len(values)
    half = (
        float(student.ppf(0.975, n - 1) * values.std(ddof=1) / np.sqrt(n))
        if n > 1
        else float("nan")
    )
    return Spread(float(values.mean()), half, float(values.max()))


def violations(commanded: Commanded) -> dict[str, np.ndarray]:
    """Steps at which a limit is broken, by kind, (m,) each: force, angle, rate (of thrust or angle), sector.

    An angle that is no number counts as "angle". A command in the forbidden sector counts where both azimuths push: one
    that turns through it without thrust disturbs nobody, nor does one that pushes there alone. A unit that cannot be
    used goes to zero at once: its rate does not count.
    """
    ship, f, a, h = (
        parameters(AllocationParameters),
        commanded.thrusts,
        commanded.azimuths,
        commanded.step,
    )
    most = np.array([ship.azimuth_thrust_max, ship.azimuth_thrust_max, ship.tunnel_thrust_max])
    least = np.array([ship.azimuth_thrust_min, ship.azimuth_thrust_min, -ship.tunnel_thrust_max])
    reach, turn = ship.thrust_rate_max * h, AZIMUTH_RATE * h
    quick = ((np.abs(np.diff(f, axis=0)) > reach * (1.0 + ALMOST)) & commanded.available[1:]).any(
        -1
    )
    turned = (np.abs(wrap(np.diff(a, axis=0))) > turn * (1.0 + ALMOST)).any(-1)
    beside = np.abs(wrap(a))
    inside = (beside > SECTOR[0] * (1.0 + ALMOST)) & (beside < SECTOR[1] * (1.0 - ALMOST))
    bad = {
        "force": ~((f <= most * (1.0 + ALMOST)) & (f >= least * (1.0 + ALMOST))).all(-1),
        "angle": ~np.isfinite(a).all(-1),
        "rate": quick | turned,
        "sector": inside.any(-1) & (np.abs(f[..., :2]) > PUSHING).all(-1),
    }
    return {kind: rows.sum(0) for kind, rows in bad.items()}


def power(thrusts: np.ndarray) -> np.ndarray:
    """Power of commands: of each unit its full power times (thrust over its limit) to the 3/2; (...,). [W]"""
    ship, full = parameters(AllocationParameters), parameters(PowerParameters)
    limits = np.where(
        thrusts < 0.0,
        [-ship.azimuth_thrust_min, -ship.azimuth_thrust_min, ship.tunnel_thrust_max],
        [ship.azimuth_thrust_max, ship.azimuth_thrust_max, ship.tunnel_thrust_max],
    )
    return (np.array(full.largest) * (np.abs(thrusts) / limits) ** 1.5).sum(-1)


def missed(commanded: Commanded) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment that the commands miss of the request, (n, m) each. [N, N.m]"""
    X, Y, N = loads(commanded.thrusts, commanded.azimuths)
    tau = commanded.tau
    return np.hypot(tau[..., 0] - X, tau[..., 1] - Y), np.abs(tau[..., 2] - N)


def reachable(commanded: Commanded, every: int) -> np.ndarray:
    """Whether limits, sectors and rates let the ship meet a request from the commands before it, (n, m).

    Of every so many requests, the first excluded; effects are taken as linear in a step's changes, which misses some
    newtons, and a request counts as met within `CLOSE`. A law that cannot turn is judged as if it could.
    """
    ship, h = parameters(AllocationParameters), commanded.step
    shape = commanded.tau.shape[:2]
    answer = np.zeros((-(-shape[0] // every), shape[1]), bool)
    scale = np.array([1.0, 1.0, 1.0 / ship.yaw_lever])
    X, Y, N = loads(commanded.thrusts, commanded.azimuths)
    for row, k in enumerate(range(0, shape[0], every)):
        for seed in range(shape[1]) if k else ():
            f, a = commanded.thrusts[k - 1, seed], commanded.azimuths[k - 1, seed]
            gap = commanded.tau[k, seed] - [X[k - 1, seed], Y[k - 1, seed], N[k - 1, seed]]
            slopes, least, most = _steps(ship, f, a, h)
            found = lsq_linear(slopes * scale[:, None], gap * scale, (least, most), method="bvls")
            answer[row, seed] = np.linalg.norm(found.fun) < CLOSE
    return answer


def _steps(ship, f, a, h):
    """Effect of changes of three thrusts [N] and two angles [rad] on the load, and how far a step may change them."""
    c, s = np.cos(a), np.sin(a)
    x, y = np.array([ship.port_x, ship.starboard_x]), np.array([ship.port_y, ship.starboard_y])
    along, across = [c, s, x * s - y * c], [-s * f[:2], c * f[:2], (x * c + y * s) * f[:2]]
    slopes = np.column_stack([np.array(along), [0.0, 1.0, ship.tunnel_x], np.array(across)])
    reach, turn = ship.thrust_rate_max * h, AZIMUTH_RATE * h
    highest = np.array([ship.azimuth_thrust_max] * 2 + [ship.tunnel_thrust_max])
    lowest = np.array([ship.azimuth_thrust_min] * 2 + [-ship.tunnel_thrust_max])
    ahead, beside = np.abs(wrap(a)) <= np.pi / 2.0, wrap(a)
    astern = np.where(beside < 0.0, beside + 2.0 * np.pi, beside)
    front, aft = np.maximum(SECTOR[0] - beside, 0.0), np.maximum(astern - SECTOR[1], 0.0)
    left = np.where(ahead, np.maximum(SECTOR[0] + beside, 0.0), aft)
    right = np.where(ahead, front, np.maximum(2.0 * np.pi - SECTOR[1] - astern, 0.0))
    little = 1e-9  # the solver wants bounds that differ
    least = np.concatenate([np.maximum(lowest - f, -reach), -np.minimum(left, turn)]) - little
    return (
        slopes,
        least,
        np.concatenate([np.minimum(highest - f, reach), np.minimum(right, turn)]) + little,
    )


def reversals(thrusts: np.ndarray) -> np.ndarray:
    """How often thrusts change sign, from beyond `TURNING` to beyond it on the other side: (n, ...) to (...)."""
    sign = np.where(thrusts > TURNING, 1, np.where(thrusts < -TURNING, -1, 0))
    flat = sign.reshape(len(sign), -1)
    counts = [int((np.diff(column[column != 0]) != 0).sum()) for column in flat.T]
    return np.reshape(counts, thrusts.shape[1:])


def settled(commanded: Commanded) -> slice:
    """Rows after the start."""
    return slice(round(SETTLED / commanded.step), None)
