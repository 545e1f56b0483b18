"""How far a sum of convex sets reaches, against SciPy's linear programmes."""

import numpy as np
import pytest
from scipy.optimize import linprog

from shipcosim.ships.attainable import largest_multiple


def by_programme(sets, left, load):
    """Largest s with sum_j c_j corners_j = s load, the c of a set not negative and 1 at most together."""
    owner = np.repeat(np.arange(len(sets)), [len(one) for one in sets])
    corners = np.vstack([one * share for one, share in zip(sets, left, strict=True)])
    equal = np.column_stack([corners.T, -load])
    most = np.column_stack([np.equal.outer(np.arange(len(sets)), owner), np.zeros(len(sets))])
    goal = np.append(np.zeros(len(corners)), -1.0)
    done = linprog(goal, most, np.ones(len(sets)), equal, np.zeros(3), (0.0, None), method="highs")
    assert done.status == 0
    return done.x[-1]


def drawn(random, kind):
    """Corners of a thruster somewhere: an azimuth, a part of its circle, one that pushes to two sides or to one."""
    x, y = random.uniform(-1.0, 1.0, 2)
    angle = random.uniform(0.0, 2.0 * np.pi)
    turns = {
        "disc": np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False),
        "sector": np.linspace(0.0, random.uniform(0.2, np.pi), 7),
        "both": np.array([0.0, np.pi]),
        "one": np.zeros(1),
    }[kind]
    force = random.uniform(0.2, 2.0) * np.column_stack(
        [np.cos(angle + turns), np.sin(angle + turns)]
    )
    return np.column_stack([force, x * force[:, 1] - y * force[:, 0]])


@pytest.mark.parametrize("seed", range(30))
def test_multiple_is_that_of_the_linear_programme(seed):
    random = np.random.default_rng(seed)
    kinds = random.choice(["disc", "sector", "both", "one"], random.integers(1, 6))
    sets = [drawn(random, kind) for kind in kinds]
    inside = np.array(
        [sum(random.dirichlet(np.ones(len(one))) @ one for one in sets) for _ in range(3)]
    )
    loads = np.concatenate([random.normal(size=(3, 3)), 10.0 * inside, np.eye(3)[:2], [sets[0][0]]])
    left = random.uniform(0.0, 1.0, (len(loads), len(sets)))
    expected = [by_programme(sets, *one) for one in zip(left, loads, strict=True)]
    assert largest_multiple(sets, left, loads) == pytest.approx(expected, rel=1e-7, abs=1e-7)


def test_nothing_is_infinitely_often_in_it_and_no_thruster_gives_nothing():
    sets = [np.zeros((2, 3)), np.array([(1.0, 0.0, 0.0)])]
    loads = np.array(
        [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1e-3, 0.0)]
    )
    assert largest_multiple(sets, np.ones((5, 2)), loads).tolist() == [np.inf, 1.0, 0.0, 0.0, 0.0]
