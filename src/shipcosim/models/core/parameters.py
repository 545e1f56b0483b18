"""Numbers that know their unit and where they come from: the fields of every parameter set."""

from dataclasses import field


def quantity(default, unit, description, origin, *, tolerance=0.0, minimum=None, maximum=None):
    """Field of a frozen dataclass of parameters.

    Parameters
    ----------
    default : float, int, bool or str
        Value unless a parameter set says otherwise. A table is a str, see `tables`.
    unit : str
        FMI style: ``"kg.m2"``, ``"N.s2/m2"``, ``"rad/s"``, ``"1"``.
    description : str
        What it is, one line.
    origin : str
        Where the number comes from, with its grade; a guess says "assumed".
    tolerance : float
        Standard deviation within which the value counts as known, in its unit.
    minimum, maximum : float, optional
        Bounds of meaningful values.
    """
    metadata = dict(
        unit=unit, description=description, origin=origin, tolerance=tolerance, minimum=minimum, maximum=maximum
    )
    return field(default=default, metadata=metadata)


def acts(value, neutral=0.0):
    """Whether a parameter changes anything: it is not the neutral number, or it is more than one number.

    What does not act can be left out; arrays are not looked into.

    Examples
    --------
    >>> acts(0.0), acts(0.1), acts(1.0, neutral=1.0)
    (False, True, False)
    """
    return not isinstance(value, (int, float)) or value != neutral
