"""Fields of parameter sets: numbers with unit, description, origin and tolerance.

References
----------
Definition.
"""

from dataclasses import field
from typing import Any

LEFT_OUT = 1e30
"""Size of a number that nobody has given. FMI wants a start value of every parameter: this is the one of a parameter
that describes a ship, positive or, where its maximum forbids that, negative; a table's is the empty text."""


def quantity(
    default: Any,
    unit: str,
    description: str,
    origin: str,
    *,
    tolerance: float = 0.0,
    share: float = 0.0,
    minimum: float | None = None,
    maximum: float | None = None,
) -> Any:
    """Field of a frozen dataclass of parameters with a default, which changes nothing or holds for any ship.

    Parameters
    ----------
    default : float, int, bool or str
        Value unless a parameter set says otherwise. A table is a str, see `tables`. [as unit says]
    unit : str
        FMI style: ``"kg.m2"``, ``"N.s2/m2"``, ``"rad/s"``, ``"1"``.
    description : str
        What it is, one line.
    origin : str
        Where the number comes from, with its grade; a guess says "assumed".
    tolerance : float
        Standard deviation within which the value counts as known. [as unit says]
    share : float
        The same of a value that is not the default, over its size, where its parameter set does not say it. [1]
    minimum, maximum : float, optional
        Bounds of meaningful values. [as unit says]

    Returns
    -------
    dataclasses.Field
        The field, whose metadata are what is given here. [as unit says]
    """
    about = _about(
        unit, description, type(default), origin=origin, tolerance=tolerance, share=share
    )
    return field(default=default, metadata=about | {"minimum": minimum, "maximum": maximum})


def required(
    unit: str,
    description: str,
    *,
    tolerance: float = 0.0,
    share: float = 0.0,
    minimum: float | None = None,
    maximum: float | None = None,
) -> Any:
    """Field of a frozen dataclass of parameters that describes a ship: a number without which there is none.

    Parameters
    ----------
    unit, description : str
        As of `quantity`.
    tolerance, share : float
        As of `quantity`, of a number whose parameter set does not say it: give one of them. [as unit says, 1]
    minimum, maximum : float, optional
        As of `quantity`. [as unit says]

    Returns
    -------
    dataclasses.Field
        The field, whose metadata are what is given here. [as unit says]
    """
    about = _about(unit, description, float, tolerance=tolerance, share=share)
    return field(metadata=about | {"minimum": minimum, "maximum": maximum})


def required_table(columns: tuple[str, ...], description: str) -> Any:
    """Field of a frozen dataclass of parameters that holds a ship's table as text, see `tables`.

    Parameters
    ----------
    columns : tuple of str
        Name and unit of each, ``"angle [deg]"``.
    description : str
        What it is, one line.

    Returns
    -------
    dataclasses.Field
        The field, whose metadata are what is given here. [as columns say]
    """
    return field(metadata=_about("1", description, str, columns=tuple(columns)))


def _about(unit: str, description: str, kind: type, **more: Any) -> dict[str, Any]:
    """Metadata of a field beside its default."""
    rest = {
        "origin": "",
        "tolerance": 0.0,
        "share": 0.0,
        "minimum": None,
        "maximum": None,
        "columns": (),
    }
    return {"unit": unit, "description": description, "kind": kind} | rest | more


def left_out(value: Any) -> bool:
    """True if a value stands for a parameter that its ship does not give.

    Parameters
    ----------
    value : float, int, bool, str or array
        Value of a parameter. [any unit]

    Returns
    -------
    bool
        Whether it stands for none.

    Examples
    --------
    >>> left_out(1e30), left_out(""), left_out(0.0)
    (True, True, False)
    """
    return (
        value == ""
        if isinstance(value, str)
        else isinstance(value, float) and abs(value) >= LEFT_OUT
    )


def acts(value: Any, neutral: float = 0.0) -> bool:
    """True if a parameter changes anything: not the neutral number, or more than one number.

    What does not act can be left out; arrays are not looked into.

    Parameters
    ----------
    value : float, int or array
        Value of a parameter. [any unit]
    neutral : float
        Value that changes nothing. [the unit of value]

    Returns
    -------
    bool
        Whether the value can change anything.

    Examples
    --------
    >>> acts(0.0), acts(0.1), acts(1.0, neutral=1.0)
    (False, True, False)
    """
    # Compiled code may get other values: there the recording decides.
    if (own := getattr(value, "maths", None)) is not None:
        return own.acts(value, neutral)
    return not isinstance(value, (int, float)) or value != neutral
