"""Fields of parameter sets: numbers with unit, description, origin and tolerance.

References
----------
Definition.
"""

from collections.abc import Callable
from dataclasses import field, make_dataclass
from typing import Any

LEFT_OUT = 1e30
"""Value that marks a missing number. FMI wants a start value of every parameter: this is the one of a parameter
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


UNITS = 6
"""Most thrusters of a ship whose thrusters have numbers. [1]"""


def numbered_units(fields_of: Callable[[int], dict[str, Any]]) -> Any:
    """Base class for parameters of the units 1 to `UNITS`: ``x_1``, ``y_1``, ``x_2`` and so on.

    Parameters
    ----------
    fields_of : callable
        From the number of a unit to its fields by name, without the number; each made by `quantity`.

    Returns
    -------
    type
        A frozen dataclass with the fields of unit 1, then those of unit 2, and so on. [as the fields]
    """
    fields = [
        (f"{name}_{number}", float, declared)
        for number in range(1, UNITS + 1)
        for name, declared in fields_of(number).items()
    ]
    return make_dataclass(
        "NumberedUnits", fields, namespace={"of_units": of_units}, frozen=True, kw_only=True
    )


def of_units(parameters: Any, name: str) -> list[float]:
    """A parameter of all units, in their order.

    Parameters
    ----------
    parameters : any
        With a base class made by `numbered_units`. [as its fields]
    name : str
        Of the parameter, without the number.

    Returns
    -------
    list of float
        One a unit. [as the parameter]
    """
    return [getattr(parameters, f"{name}_{number}") for number in range(1, UNITS + 1)]


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
    if (maths := getattr(value, "maths", None)) is not None:
        return maths.acts(value, neutral)
    return not isinstance(value, (int, float)) or value != neutral
