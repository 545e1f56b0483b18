"""A number that a formula gives."""

from typing import NamedTuple


class EstimatedNumber(NamedTuple):
    """An estimated number with its tolerance and source.

    Attributes
    ----------
    value : float or str
        In the unit of the parameter that takes it; a table is a str.
    tolerance : float
        Standard deviation, in the same unit.
    source : str
        The formula's.
    """

    value: float | str
    tolerance: float
    source: str


def within(value: float, share: float, source: str) -> EstimatedNumber:
    """An estimate whose tolerance is a share of its size.

    Parameters
    ----------
    value : float
        In the unit of the parameter.
    share : float
        Standard deviation over the size of the value. [1]
    source : str
        The formula's.

    Returns
    -------
    EstimatedNumber
    """
    return EstimatedNumber(value, share * abs(value), source)
