"""Timing and reporting that all measurements of speed share."""

import time
from collections.abc import Callable, Sequence
from statistics import median


def cpu_seconds(function: Callable[[], object]) -> float:
    """CPU time of a call in one thread; other work on the machine does not count. [s]"""
    start = time.process_time()
    function()
    return time.process_time() - start


def reported(what: str, values: Sequence[float], unit: str, to_reach: str) -> float:
    """Median of repeated measurements, printed with their spread and what is to be reached."""
    middle = median(values)
    low, high = min(values), max(values)
    print(
        f"\n{what}: {middle:.3g} {unit} (median of {len(values)}, {low:.3g} to {high:.3g}); to reach {to_reach}"
    )
    return middle
