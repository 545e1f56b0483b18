"""Features of turning circles whose track is known in closed form."""

import numpy as np
import pytest

from shipcosim.diagnose.sea_trials.features import FEATURES, features_of
from shipcosim.diagnose.sea_trials.windows import SeaTrial

SPEED, RADIUS = 5.0, 80.0  # m/s, m


def circle(side=1, current=(0.0, 0.0), compass=0.0, course=0.7, drift=0.1):
    """A ship that goes round at once with a drift angle, logged in a current by a compass that is off."""
    time = np.arange(0.0, 540.0) * np.radians(1.0) * RADIUS / SPEED
    turned = time * SPEED / RADIUS
    ahead, across = RADIUS * np.sin(turned), RADIUS * (1.0 - np.cos(turned))
    c, s = np.cos(course), np.sin(course)
    north = c * ahead - side * s * across + current[0] * time
    east = s * ahead + side * c * across + current[1] * time
    path = course + side * turned
    heading = path + side * drift + compass
    going = SPEED * np.cos(path) + current[0], SPEED * np.sin(path) + current[1]
    u = np.cos(heading) * going[0] + np.sin(heading) * going[1]
    v = -np.sin(heading) * going[0] + np.cos(heading) * going[1]
    measured = np.column_stack(
        (north, east, heading, u, v, np.full(time.size, side * SPEED / RADIUS))
    )
    return SeaTrial("turning circle", side, (0.0, float(time[-1])), 0.5, time, measured, {}, True)


def told(trial):
    return dict(zip(FEATURES["turning circle"], features_of(trial, trial.measured), strict=True))


@pytest.mark.parametrize("side", [1, -1])
def test_advance_transfer_and_tactical_diameter_of_a_circle_are_its_radius_and_diameter(side):
    found = told(circle(side))
    assert [
        np.exp(found[name]) for name in ("advance", "transfer", "tactical diameter")
    ] == pytest.approx([RADIUS, RADIUS, 2.0 * RADIUS], rel=1e-3)


@pytest.mark.parametrize("side", [1, -1])
def test_a_current_and_a_wrong_compass_change_no_distance(side):
    """Transfer is across the first course, so neither heading nor drift of the water turns it."""
    plain, found = (
        told(circle(side)),
        told(circle(side, current=(0.2, -0.15), compass=np.radians(3.0))),
    )
    for name in ("advance", "transfer", "tactical diameter"):
        assert found[name] == pytest.approx(plain[name], abs=2e-3)


def test_a_circle_to_port_mirrors_one_to_starboard():
    port, starboard = told(circle(-1)), told(circle(1))
    assert port == pytest.approx(starboard, abs=1e-6)
