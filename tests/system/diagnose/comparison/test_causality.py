"""Past commands tell the next velocities only if the ship obeys them, also where a controller answers the motion."""

from types import SimpleNamespace

import numpy as np
import pytest

from shipcosim.diagnose.comparison.causality import causal_support
from shipcosim.models.core.motion import Motion


def closed_loop(seed, sense=1.0, n=3000, h=0.4):
    """A craft whose yaw is kept by a moment against weather, logged with a sense of the moment."""
    rng = np.random.default_rng(seed)
    weather = np.zeros(n)
    psi, r, moment = np.zeros(n), np.zeros(n), np.zeros(n)
    for k in range(n - 1):
        weather[k + 1] = 0.97 * weather[k] + 0.02 * rng.standard_normal()
        moment[k] = -0.3 * psi[k] - 0.5 * r[k] + 0.02 * rng.standard_normal()
        r[k + 1] = r[k] + h * (moment[k] + weather[k] - 0.2 * r[k])
        psi[k + 1] = psi[k] + h * r[k + 1]
    still = np.zeros(n)
    measured = SimpleNamespace(
        motion=Motion(still, still, psi, still, still, r),
        usable=np.ones(n, bool),
        kernel=SimpleNamespace(step=h),
    )
    load = np.stack([still, still, sense * moment])
    return measured, SimpleNamespace(thrusters={"one": load}, hull=0.0 * load)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_right_sense_is_told_although_a_controller_answers_the_motion(seed):
    measured, right = closed_loop(seed)
    _, wrong = closed_loop(seed, -1.0)
    one, other = causal_support(measured, [right, wrong], 1.0)
    assert one > other + 8.0


def test_commands_that_do_nothing_tell_nothing():
    measured, _ = closed_loop(4)
    noise = np.random.default_rng(5).standard_normal((3, measured.usable.size))
    gains = causal_support(
        measured,
        [SimpleNamespace(thrusters={"one": s * noise}, hull=0.0 * noise) for s in (1, -1)],
        1.0,
    )
    assert np.abs(gains).max() < 5.0
