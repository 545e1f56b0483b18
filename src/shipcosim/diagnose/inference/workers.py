"""Independent computations side by side, as many as the processor has cores for.

They are threads: the compiled filter and NumPy's loops let others run meanwhile, and nothing is copied to another
process. Each computation is the same as alone, so results are equal to the last digit however many run.
"""

import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from shipcosim.options import cores

MOST = 4
"""More would hold each other up: Python itself runs in one thread at a time."""
_inside = threading.local()


def each(function: Callable[..., Any], *arguments: Iterable) -> list[Any]:
    """Results of a function, in the order of its arguments, as `map` has them.

    A function that is called so and does the same inside gets no further threads.
    """
    calls = list(zip(*arguments, strict=True))
    workers = min(cores(), len(calls), MOST)
    if workers < 2 or getattr(_inside, "one", False):
        return [function(*call) for call in calls]
    with ThreadPoolExecutor(workers, initializer=_mark) as pool:
        return list(pool.map(function, *zip(*calls, strict=True)))


def _mark():
    _inside.one = True
