"""Requests of a DP controller that allocators are trained on, recorded by docs/generators/write_requests.py."""

from pathlib import Path

import numpy as np

REQUESTS = Path(__file__).with_name("requests.npz")
"""Requests in various weather: arrays of m runs, n times and X, Y, N, in multiples of the array `unit`."""
FIRST_SEED = 1001
"""Seeds of wind and waves from here on are those of training; scenarios and benchmarks have others."""


def recorded_requests(every: int = 1) -> tuple[list[np.ndarray], np.ndarray, float]:
    """Requests of all runs.

    Parameters
    ----------
    every : int
        Takes each so-manieth of the recorded requests.

    Returns
    -------
    list of (m, n, 3) arrays
        Runs of one length each. [N, N, N.m]
    (k,) array of int
        Seeds of the runs.
    float
        Time from one request to the next. [s]
    """
    # Stored as multiples of a unit to save space; scale them back.
    with np.load(REQUESTS) as found:
        runs = [
            (found[kind][:, ::every] * found["unit"]).astype(np.float32)
            for kind in ("stationkeeping", "four_corner")
        ]
        return runs, found["seeds"], every * float(found["interval"])
