"""The optimal allocator with its default numbers: states, steps, and how many limits a step breaks."""

from dataclasses import replace
from math import pi, radians

import numpy as np
from ships import parameters

from shipcosim.models.allocation import cones, optimal, sqp

PARAMETERS = parameters(optimal.OptimalParameters)
DESIGN = optimal.design(PARAMETERS)
ALL = (True, True, True)
H = 0.05  # s
CONES = [[(radians(-80), radians(80)), (radians(100), radians(260))]] * 2 + [[]]
SETTLED = (radians(45), radians(135), 0.5 * pi)


ALWAYS = optimal.design(replace(PARAMETERS, sectors_always=1.0))


def step(state, tau, available=ALL, h=H, design=DESIGN, **changes):
    return optimal.step(state, tau, available, h, parameters=PARAMETERS, design=design, **changes)


def start(tau=(0.0, 0.0, 0.0), azimuths=SETTLED):
    return cones.cones_at_rest(sqp.resting(tau, azimuths), tau, design=DESIGN)


def held(tau, state=None, steps=1200):
    """State after a request that stays."""
    state = state or start()
    for _ in range(steps):
        state = step(state, tau)
    return state


def many(number, tau=0.0):
    """States of many runs, each at rest at admissible angles of its own."""
    draw = np.random.default_rng(number)
    port, starboard = draw.uniform(-80, 80, number), draw.uniform(100, 260, number)
    return start(
        (np.zeros(number),) * 3,
        (np.radians(port), np.radians(starboard), np.full(number, 0.5 * pi)),
    )


def violations(old, new, h=H, available=ALL, always=False):
    """How many commands break a limit of thrust, angle, rate or sector; a sector counts while the other azimuth runs."""
    count = 0
    runs = [np.asarray(f) != 0.0 for f in new.thrusts[:2]]
    both = always | (runs[0] & runs[1])
    for unit, f0, a0, f, a, on in zip(
        DESIGN.units, old.thrusts, old.azimuths, new.thrusts, new.azimuths, available, strict=True
    ):
        count += np.sum((f > unit.most) | (f < unit.least_degraded))
        count += np.sum((np.abs(f - f0) > unit.thrust_rate * h * (1 + 1e-9)) & np.asarray(on))
        count += np.sum(np.abs(a - a0) > unit.azimuth_rate * h * (1 + 1e-9))
        aside = np.abs(np.degrees(np.arctan2(np.sin(a), np.cos(a))))
        if unit.azimuth_rate > 0.0:
            count += np.sum((aside > 80.0 + 1e-9) & (aside < 100.0 - 1e-9) & (f != 0.0) & both)
            count += np.sum((f < 0.0) & (f < f0) & np.logical_and.reduce(available))
        count += np.sum((np.asarray(f) != 0.0) & ~np.asarray(on))
    return int(count)
