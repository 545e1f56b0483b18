"""The base class of every FMU of this project."""

import functools
from collections.abc import Callable
from typing import Any

from shipcosim.fmi.shell import Fmi2Slave
from shipcosim.fmi.variables import leave_start_values, variables_of


class Fmu(Fmi2Slave):
    """A component: declare variables on the class, write `step`, and `start` if needed.

    Variables are plain attributes of the instance. Any other attribute is state: it is kept, saved and restored with
    the FMU. The class works without FMI as well, see the example.

    Attributes
    ----------
    author, licence, version : str
        For the model description; a version that is left empty is that of shipcosim.
    default_step_size : float
        Proposed to the host. [s]
    instance_name : str
        The component's name in its system.
    start_time : float
        Time at the start of the run. [s]

    Examples
    --------
    >>> from shipcosim.fmi import Fmu, Input, Output, Parameter
    >>> class Lag(Fmu):
    ...     '''First-order lag.'''
    ...
    ...     value_in = Input("1", "what to follow")
    ...     value = Output("1", "what follows")
    ...     time_constant = Parameter(2.0, "s", "time constant")
    ...
    ...     def step(self, t, h):
    ...         self.value += h / self.time_constant * (self.value_in - self.value)
    >>> lag = Lag()
    >>> lag.value_in = 1.0
    >>> lag.start()
    >>> lag.step(0.0, 0.1)
    >>> lag.value
    0.05
    """

    author = "shipcosim"
    licence = "MIT"
    version = ""
    default_step_size = 0.05

    def __init_subclass__(cls, **kwargs: Any) -> None:
        # State is created in start(), which the host may repeat.
        if "__init__" in vars(cls):
            raise TypeError(
                f"{cls.__name__} has an __init__: an FMU makes its state in start(self)"
            )
        # Names of the shell would be overwritten by variables.
        cls.variables, cls.groups = variables_of(cls)
        taken = sorted({item.name for item in (*cls.variables, *cls.groups)} & set(dir(Fmu)))
        if taken:
            raise TypeError(
                f"{cls.__name__} names a variable {', '.join(taken)}, which the shell uses itself"
            )
        # Instances read their start values from the class.
        leave_start_values(cls)
        if "start" in vars(cls):
            cls.start = _with_fresh_groups(cls.start)
        super().__init_subclass__(**kwargs)

    def start(self) -> None:
        """Set state and outputs for the start from parameters and inputs.

        The host may call it several times while components agree on their first values, so it must not depend on
        what an earlier call left.
        """
        _drop_groups(self)

    def repeat(self, going: Callable[[], Any], turn: Callable[[], None]) -> None:
        """Repeat a turn, which changes attributes, while a condition holds: a while loop.

        A step with its loops in this form can be exported as compiled code.

        Parameters
        ----------
        going : callable
            ``going()`` says whether there is another turn.
        turn : callable
            ``turn()`` takes it.
        """
        # While a step is recorded, the condition is a symbol: the recorder writes the loop.
        condition = going()
        if (maths := getattr(condition, "maths", None)) is not None:
            maths.repeat_of(self, going, turn)
            return
        while condition:
            turn()
            condition = going()

    def step(self, t: float, h: float) -> None:
        """Advance from `t` to `t + h`: read inputs, write outputs.

        Parameters
        ----------
        t : float
            Time at the start of the step. [s]
        h : float
            Length of the step. [s]
        """
        raise NotImplementedError(f"{type(self).__name__} has no step(self, t, h)")


def _drop_groups(fmu: Fmu) -> None:
    """Drop dataclasses of parameters with outdated values; the next access makes new ones."""
    values = fmu.__dict__
    for group in fmu.groups:
        if group.name in values and not group.holds(values):
            del values[group.name]


def _with_fresh_groups(start: Callable[[Any], None]) -> Any:
    @functools.wraps(start)
    def fresh(self: Fmu) -> None:
        _drop_groups(self)
        start(self)

    return fresh
