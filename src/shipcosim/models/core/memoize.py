"""Memoised functions: results cached by their arguments, in any arithmetic.

References
----------
Definition.
"""

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import Any


def kept(most: int) -> Callable[[Callable], Callable]:
    """Decorate a function without side effects, so that its results are cached.

    Parameters
    ----------
    most : int
        Number of results that are kept. [1]

    Returns
    -------
    callable
        The decorator. Arguments that record what is computed with them, known by their `maths`, keep results in their
        own way; for arrays nothing is kept.

    Examples
    --------
    >>> @kept(8)
    ... def square(x):
    ...     print("computed")
    ...     return x * x
    >>> square(3.0), square(3.0)
    computed
    (9.0, 9.0)
    """

    def decorate(function: Callable) -> Callable:
        remembered = lru_cache(maxsize=most)(function)

        @wraps(function)
        def call(*arguments: Any) -> Any:
            # While a computation is recorded, the recording caches: compiled code must call again
            # when arguments change.
            for argument in arguments:
                if (maths := getattr(argument, "maths", None)) is not None:
                    return maths.kept(function, arguments)
            # Arrays have no hash; these calls are computed each time.
            try:
                hash(arguments)
            except TypeError:
                return function(*arguments)
            return remembered(*arguments)

        return call

    return decorate
