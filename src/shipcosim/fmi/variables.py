"""Declarations on an FMU's class: inputs, outputs and parameters."""

import dataclasses
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from shipcosim.models.core.parameters import LEFT_OUT, left_out

Value = float | int | bool | str
"""Value of a variable of FMI."""
TYPES = {bool: "Boolean", int: "Integer", float: "Real", str: "String"}


class Variable:
    """One scalar variable of an FMU; use `Input`, `Output`, `Parameter`.

    Attributes
    ----------
    name : str
        As declared on the class.
    causality : str
        "input", "output" or "parameter".
    type : str
        "Real", "Integer", "Boolean" or "String", from the start value.
    start : float, int, bool or str
        Value before anything is set. Of a `required` parameter it stands for none: the FMU refuses to start with it.
    required : bool
        A parameter without a value of its own: declared with a type, ``float`` or ``str``, in place of a start value.
    unit, description : str
        Unit in FMI's spelling ("N.s2/m2", "rad", "1"), one line of text.
    minimum, maximum : float or int or None
        Bounds; those of parameters are enforced.
    tunable : bool
        A parameter that may change during the run.
    optional : bool
        An input that a system may leave unconnected, as one that sets off a failure.
    origin : str
    tolerance : float
        Of a parameter, see `shipcosim.models.core.parameters`.
    """

    causality = ""

    def __init__(
        self,
        start: Any,
        unit: str,
        description: str,
        *,
        minimum: float | None = None,
        maximum: float | None = None,
        tunable: bool = False,
        optional: bool = False,
        origin: str = "",
        tolerance: float = 0.0,
    ):
        # A type in place of a value: the parameter has no default, and a mark stands for it.
        self.required = start in (float, str)
        if self.required:
            start = "" if start is str else LEFT_OUT if maximum is None else -LEFT_OUT
        # The type of the start value is that of the variable.
        if type(start) not in TYPES:
            raise TypeError(
                f"start value {start!r} of '{description}': give a float, an int, a bool or a str"
            )
        if type(start) is int and unit != "1":
            raise TypeError(
                f"'{description}' in {unit} starts at the whole number {start}: write {float(start)}"
            )
        self.name = ""
        self.type = TYPES[type(start)]
        self.start = start
        self.unit = unit
        self.description = description
        self.minimum = minimum
        self.maximum = maximum
        self.tunable = tunable
        self.optional = optional
        self.origin = origin
        self.tolerance = tolerance
        if outside := self.outside(start):
            raise ValueError(f"start value of '{description}' is {outside}")

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    if TYPE_CHECKING:  # an instance of the FMU has a value in the place of its variable

        def __get__(self, instance: Any, owner: type | None = None) -> Any: ...

    def __repr__(self) -> str:
        return f"<{self.causality} {self.name}: {self.type}, {self.start!r} {self.unit}>"

    @property
    def bounds(self) -> tuple[float, float]:
        """Minimum and maximum; infinite without a limit."""
        low = -math.inf if self.minimum is None else self.minimum
        return low, math.inf if self.maximum is None else self.maximum

    def is_left_out(self, value: Any) -> bool:
        """True if a value is the mark of a parameter without a default."""
        return self.required and left_out(value)

    def outside(self, value: Any) -> str:
        """Reason why a value is impossible for this variable; empty if it is possible."""
        if self.type not in ("Real", "Integer"):
            return ""
        if not math.isfinite(value):
            return f"{value}, not a finite number"
        if self.minimum is not None and value < self.minimum:
            return f"{value:.9g}, below its minimum {self.minimum:.9g} [{self.unit}]"
        if self.maximum is not None and value > self.maximum:
            return f"{value:.9g}, above its maximum {self.maximum:.9g} [{self.unit}]"
        return ""


class Signal(Variable):
    """Input or output: its unit comes first, and it starts at zero."""

    def __init__(
        self,
        unit: str,
        description: str,
        *,
        start: Value = 0.0,
        minimum: float | None = None,
        maximum: float | None = None,
        optional: bool = False,
    ):
        super().__init__(
            start, unit, description, minimum=minimum, maximum=maximum, optional=optional
        )


class Input(Signal):
    """Input at every step: ``thrust_cmd = Input("N", "commanded thrust")``.

    With ``optional=True`` a system may leave it unconnected: `shipcosim check` does not remark on it.
    """

    causality = "input"


class Output(Signal):
    """Result of the FMU: ``thrust = Output("N", "delivered thrust")``."""

    causality = "output"


class Parameter(Variable):
    """Set before the run: ``thrust_max = Parameter(40e3, "N", "largest thrust")``.

    A ship's parameter has a type in place of a start value: ``Parameter(float, "N", "thrust")``.
    """

    causality = "parameter"


PLAIN = (float, int, bool, str)
"""Types of values that are compared; what stands in their place when a start is recorded is not."""


class Parameters:
    """A frozen dataclass of parameters, each field an FMU parameter: ``model = Parameters(HullParameters)``.

    In `start` and `step` the attribute is the dataclass made of the values that were set.

    Parameters
    ----------
    kind : type
        Frozen dataclass with fields made by `quantity` and `required` of `shipcosim.models.core.parameters`.
    prefix : str
        Put before the fields' names, where two groups would clash.
    """

    def __init__(self, kind: type, *, prefix: str = ""):
        if not (dataclasses.is_dataclass(kind) and vars(kind)["__dataclass_params__"].frozen):
            raise TypeError(f"Parameters({kind.__name__}): give a frozen dataclass")
        self.kind = kind
        self.prefix = prefix
        self.name = ""
        self.variables = [self._variable(field) for field in dataclasses.fields(kind) if field.init]

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        """The dataclass; the first access makes it and stores it on the instance for speed."""
        if instance is None:
            return self
        values = instance.__dict__
        # Parameters without a value of their own must have been set.
        if missing := [
            variable for variable in self.variables if variable.is_left_out(values[variable.name])
        ]:
            raise ValueError(text_of_left_out(missing))
        # Fields have the names of the variables without the prefix.
        start = len(self.prefix)
        group = self.kind(
            **{variable.name[start:]: values[variable.name] for variable in self.variables}
        )
        values[self.name] = group
        return group

    def holds(self, values: Mapping[str, Any]) -> bool:
        """True if the stored dataclass has the present values of the instance."""
        made = values[self.name]
        start = len(self.prefix)
        pairs = (
            (getattr(made, variable.name[start:]), values[variable.name])
            for variable in self.variables
        )
        return all(
            stored is other or (type(stored) is type(other) in PLAIN and stored == other)
            for stored, other in pairs
        )

    def _variable(self, field: dataclasses.Field) -> "Parameter":
        # Unit, bounds and origin are in the field's metadata.
        about = field.metadata
        if "unit" not in about:
            raise TypeError(
                f"{self.kind.__name__}.{field.name}: make it with quantity(default, unit, description, origin), or "
                "required(unit, description)"
            )
        # Without a default the type stands for it: the parameter is required.
        default: Any = about["kind"] if field.default is dataclasses.MISSING else field.default
        default = (
            float(default) if field.type in (float, "float") and default is not float else default
        )
        bounds = {
            key: about[key] for key in ("minimum", "maximum", "origin", "tolerance") if key in about
        }
        try:
            variable = Parameter(default, about["unit"], about["description"], **bounds)
        except (TypeError, ValueError) as error:
            raise type(error)(f"{self.kind.__name__}.{field.name}: {error}") from None
        variable.name = self.prefix + field.name
        return variable


def text_of_left_out(variables: Iterable[Variable]) -> str:
    """Message on all parameters that were left out."""
    names = ", ".join(v.name if v.type == "String" else f"{v.name} [{v.unit}]" for v in variables)
    return f"parameters left out, which have no value of their own: {names}. Give them, as a ship's parameter set does"


def variables_of(cls: type) -> tuple[tuple[Variable, ...], tuple[Parameters, ...]]:
    """Variables and parameter groups of a class and its bases.

    Returns
    -------
    variables : tuple of Variable
        Inputs, outputs, parameters, each in the order of declaration.
    groups : tuple of Parameters

    Raises
    ------
    TypeError
        Two variables have one name.
    """
    # Base classes first: a derived class may replace their variables.
    declared = {}
    for base in reversed(cls.__mro__):
        declared |= _declared_on(base)
    groups = tuple(item for item in declared.values() if isinstance(item, Parameters))
    variables = [item for item in declared.values() if isinstance(item, Variable)]
    variables += [variable for group in groups for variable in group.variables]
    # A name may occur once, in groups too.
    names = [variable.name for variable in variables] + [group.name for group in groups]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise TypeError(
            f"{cls.__name__} declares {', '.join(twice)} twice; Parameters(..., prefix=...) keeps groups apart"
        )
    order = ("input", "output", "parameter")
    return tuple(sorted(variables, key=lambda variable: order.index(variable.causality))), groups


def leave_start_values(cls: type) -> None:
    """Put the start value of each declared variable in its place on the class.

    Python reads attributes five times as fast if a number stands behind them, not an object of
    ours.
    """
    cls._declared = _declared_on(cls)
    for name, item in cls._declared.items():
        if isinstance(item, Variable):
            setattr(cls, name, item.start)


def _declared_on(cls: type) -> dict[str, Variable | Parameters]:
    """Variables and parameter groups that a class itself declares, by name."""
    items = vars(cls).get("_declared", vars(cls)).items()
    return {name: item for name, item in items if isinstance(item, (Variable, Parameters))}
