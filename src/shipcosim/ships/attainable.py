"""Loads that thrusters can give together: how far such a set reaches in a direction.

Each thruster gives a convex set of loads, which lies in a plane of forces and moment; together they give the sum of
these sets. A load s w lies in that sum if n.(s w) <= sum_j h_j(n) for every n, with h_j(n) the largest n.f of the set
j. It is enough to look at the normals of the facets of the sum. They stand on two edges of different sets, or on the
plane of one. Other n do no harm, so no facet has to be told from what is none. Where the sum is flat, edges along the
axes take the place of those that are missing.

Reference: Schneider, Convex Bodies: The Brunn-Minkowski Theory, 2nd ed., Cambridge University Press, 2014, sec. 1.7
and 2.4.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["largest_multiple"]

ASIDE = 1e-9
"""Cosine between a normal and a load below which the load lies along the facet."""

NOTHING = 1e-12
"""Reach over that of the largest set below which it is rounding."""


def largest_multiple(sets: Sequence[NDArray], left: NDArray, loads: NDArray) -> NDArray:
    """Largest multiple of each load that lies in a sum of convex sets.

    Parameters
    ----------
    sets : sequence of (k, 3) array
        Corners of each, in a plane; no load is in it too. Forces and moment should be scaled to be of one size.
    left : (m, sets) array
        Share of each set that is left for each load. [1]
    loads : (m, 3) array

    Returns
    -------
    (m,) array
        0 where nothing is given in this direction, infinite for no load. [1]

    Examples
    --------
    Two forces side by side, of 3 and 2 at most, and the moment of the second:

    >>> sets = [np.array([(3.0, 0.0, 0.0)]), np.array([(2.0, 0.0, 2.0)])]
    >>> largest_multiple(sets, np.ones((2, 2)), np.array([(1.0, 0.0, 0.0), (4.0, 0.0, 1.0)])).round(12)
    array([3., 1.])
    """
    corners = [np.vstack([np.zeros(3), one]) for one in sets]
    normals = _normals([_edges(one) for one in corners])
    most = np.stack([(normals @ one.T).max(axis=1) for one in corners], axis=1)
    size = np.linalg.norm(loads, axis=1)
    found = np.full(len(loads), np.inf)
    for row in np.flatnonzero(size):
        along = normals @ (loads[row] / size[row])
        facing = along > ASIDE
        reach = np.min(most[facing] @ left[row] / along[facing])
        found[row] = reach / size[row] if reach > NOTHING * most.max() else 0.0
    return found


def _normals(edges: list[NDArray]) -> NDArray:
    """Unit vectors, in both directions, on each edge of a set and one of another, or on two of one set."""
    groups = [*edges, np.eye(3)]
    pairs = [
        np.cross(a[:, None], b[None]).reshape(-1, 3)
        for i, a in enumerate(groups)
        for b in groups[:i]
    ]
    pairs += [np.cross(one[:1], one) for one in edges]
    found = np.concatenate([np.eye(3), *pairs])
    length = np.linalg.norm(found, axis=1, keepdims=True)
    found = (found / np.maximum(length, 1e-300))[length[:, 0] > 1e-12]
    return np.concatenate([found, -found])


def _edges(corners: NDArray) -> NDArray:
    """Unit vectors along the edges of the convex hull of corners in a plane, (k, 3)."""
    middle = corners - corners.mean(axis=0)
    plane = np.linalg.svd(middle, full_matrices=False)[2][:2]
    hull = corners[_hull(middle @ plane.T)]
    edges = np.roll(hull, -1, axis=0) - hull
    length = np.linalg.norm(edges, axis=1, keepdims=True)
    return (edges / np.maximum(length, 1e-300))[length[:, 0] > 0.0]


def _hull(points: NDArray) -> list[int]:
    """Rows of the corners of the convex hull of (k, 2) points, in order (Andrew's monotone chain)."""

    def half(rows):
        chain: list[int] = []
        for row in rows:
            while len(chain) > 1 and _turn(*points[[*chain[-2:], row]]) <= 0.0:
                chain.pop()
            chain.append(row)
        return chain[:-1]

    rows = np.lexsort(points.T[::-1]).tolist()
    return half(rows) + half(rows[::-1])


def _turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
