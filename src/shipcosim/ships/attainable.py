"""Loads that thrusters can give together: how far their set reaches in a direction.

Each thruster gives a convex set of loads, which lies in a plane of forces and moment; together
they give the sum of these sets. A load s w lies in that sum if n.(s w) <= sum_j h_j(n) for every n,
with h_j(n) the largest n.f of set j. The normals of the facets of the sum suffice: each stands on
two edges of different sets, or on the plane of one. More normals do no harm, so all candidates are
used. Where the sum is flat, edges along the axes replace the missing ones.

Reference: Schneider, Convex Bodies: The Brunn-Minkowski Theory, 2nd ed., Cambridge University Press, 2014, sec. 1.7
and 2.4.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

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
    # The zero load belongs to every set: a thruster can stop.
    corners = [np.vstack([np.zeros(3), vertices]) for vertices in sets]
    normals = _normals([_edges(corner) for corner in corners])
    # Support h_j(n) of each set in each direction.
    most = np.stack([(normals @ corner.T).max(axis=1) for corner in corners], axis=1)
    # For each load the facet that limits it first: s = min over n of h(n).left / n.w.
    size = np.linalg.norm(loads, axis=1)
    multiples = np.full(len(loads), np.inf)
    for row in np.flatnonzero(size):
        # Only facets that face the load limit it.
        along = normals @ (loads[row] / size[row])
        facing = along > ASIDE
        # A reach that is zero except for rounding means that no load is possible in this direction.
        reach = np.min(most[facing] @ left[row] / along[facing])
        multiples[row] = reach / size[row] if reach > NOTHING * most.max() else 0.0
    return multiples


def _normals(edges: list[NDArray]) -> NDArray:
    """Unit normals, in both directions: on edges of two different sets, or on a set's plane."""
    # Axes stand in for edges where the sum is flat.
    groups = [*edges, np.eye(3)]
    pairs = [
        np.cross(a[:, None], b[None]).reshape(-1, 3)
        for i, a in enumerate(groups)
        for b in groups[:i]
    ]
    # Normal of the plane of each set.
    pairs += [np.cross(edge[:1], edge) for edge in edges]
    normals = np.concatenate([np.eye(3), *pairs])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    # Parallel edges give no normal.
    normals = (normals / np.maximum(length, 1e-300))[length[:, 0] > 1e-12]
    return np.concatenate([normals, -normals])


def _edges(corners: NDArray) -> NDArray:
    """Unit vectors along the edges of the convex hull of corners in a plane, (k, 3)."""
    # Principal plane of the corners, then their hull within it.
    middle = corners - corners.mean(axis=0)
    plane = np.linalg.svd(middle, full_matrices=False)[2][:2]
    hull = corners[_hull(middle @ plane.T)]
    edges = np.roll(hull, -1, axis=0) - hull
    # Points of zero distance give no edge.
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

    # Sort by the first coordinate, then lower and upper half of the hull.
    rows = np.lexsort(points.T[::-1]).tolist()
    return half(rows) + half(rows[::-1])


def _turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
