"""A component in a run: its FMU's instance and the prepared calls that exchange its values."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from shipcosim.cosim.master.plan import Rows
from shipcosim.cosim.master.signals import Exchange
from shipcosim.cosim.profile import Profile
from shipcosim.cosim.slaves.slave import BUFFER_TYPES, FAILED, Call, Slave, SlaveError, Step
from shipcosim.ssp import Variable


@dataclass
class DiscreteSetter:
    """Prepared call that sets inputs other than Real, only when a value has changed.

    Parameters
    ----------
    function : str
        Its name in FMI, without prefix, for messages.
    exchange : Exchange
        Holds the values.
    call : callable
        Makes the call and returns the status.
    version : int
        Of the exchange's inputs that were set last.
    """

    function: str
    exchange: Exchange
    call: Call
    version: int = -1


@dataclass
class ComponentInstance:
    """A component in a run.

    Parameters
    ----------
    name : str
        Of the component.
    slave : Slave
        Its FMU.
    multiple : int
        Its step, in base steps.
    fixed_step : float, optional
        The step that it gets, for an FMU that takes no other: the difference of two times is not always the
        same number. [s]
    feeds : bool
        Whether a connection leads from it to a component.
    input_rows, output_rows : dict of str to Rows
        First row and variables of its inputs and outputs, by kind.
    """

    name: str
    slave: Slave
    multiple: int
    fixed_step: float | None = None
    feeds: bool = True
    input_rows: dict[str, Rows] = field(default_factory=dict)
    output_rows: dict[str, Rows] = field(default_factory=dict)
    _set_reals: Call | None = None
    _discrete: list[DiscreteSetter] = field(default_factory=list)
    _gets: list[tuple[str, Call]] = field(default_factory=list)

    def __post_init__(self):
        self._do_step = do_step = self.slave.stepper()
        # Some FMUs accept one step size only. A difference of two times may be off in the last
        # digit, so they get the same number each time.
        if (step := self.fixed_step) is not None:
            self._do_step = lambda time, _: do_step(time, step)

    def steps_by(self, do_step: Step) -> None:
        """Use another call to step: that of a group with one solver."""
        self._do_step = do_step

    def count_in(self, profile: Profile) -> None:
        """Count the time of its calls from now on."""
        self._do_step = profile.timed(self.name, "step", self._do_step)
        self.write = profile.timed(self.name, "exchange", self.write)
        self.read = profile.timed(self.name, "exchange", self.read)

    def prepare(self, kind: str, exchange: Exchange, outputs: Rows, inputs: Rows) -> None:
        """Prepare the calls for the variables of one kind.

        Parameters
        ----------
        kind : str
            A key of BUFFER_TYPES.
        exchange : Exchange
            Holds their values.
        outputs, inputs : Rows
            First row and variables of this component.
        """
        self.output_rows[kind], self.input_rows[kind] = outputs, inputs
        (first, variables) = outputs
        (first_input, inputs_set) = inputs
        # The buffers are views of the exchange: the calls read and write its arrays without copies.
        if variables:
            buffer = exchange.sources[first : first + len(variables)]
            self._gets.append((f"Get{kind}", self.slave.getter(kind, variables, buffer)))
        if inputs_set:
            call = self.slave.setter(
                kind, inputs_set, exchange.inputs[first_input : first_input + len(inputs_set)]
            )
            # Reals change at every step. Other types change seldom and are set only then.
            if kind == "Real":
                self._set_reals = call
            else:
                self._discrete.append(DiscreteSetter(f"Set{kind}", exchange, call))

    def write(self) -> None:
        """Set the inputs of the FMU."""
        if self._set_reals is not None and (status := self._set_reals()) >= FAILED:
            self.slave.check("SetReal", status)
        for discrete in self._discrete:
            if discrete.version != discrete.exchange.version:
                if (status := discrete.call()) >= FAILED:
                    self.slave.check(discrete.function, status)
                discrete.version = discrete.exchange.version

    def restore(self, state: bytes) -> None:
        """Restore the FMU's state. All discrete inputs are set again in the next step."""
        self.slave.restore(state)
        for discrete in self._discrete:
            discrete.version = -1

    def rewind(self, state: Any, values: Sequence[tuple[Variable, object]]) -> None:
        """Return the FMU to its state before the start, with some new start values."""
        self.slave.rewind(state)
        set_start_values(self.slave, values)
        for discrete in self._discrete:
            discrete.version = -1

    def step(self, time: float, step_size: float) -> None:
        """Advance the FMU from a time by a step size. [s, s]"""
        if (status := self._do_step(time, step_size)) >= FAILED:
            self.slave.check("DoStep", status)

    def read(self) -> None:
        """Get the outputs of the FMU."""
        for function, call in self._gets:
            if (status := call()) >= FAILED:
                self.slave.check(function, status)


def set_start_values(slave: Slave, values: Sequence[tuple[Variable, object]]) -> None:
    """Set (variable, value) pairs before the initialisation, structural parameters first."""
    # FMI 3.0: structural parameters size the arrays, and only configuration mode takes them.
    structural = [pair for pair in values if pair[0].causality == "structuralParameter"]
    if structural:
        slave.call("EnterConfigurationMode")
        _set(slave, structural)
        slave.call("ExitConfigurationMode")
    _set(slave, [pair for pair in values if pair[0].causality != "structuralParameter"])


def _set(slave, values):
    # One FMI call per type. Integers beyond 32 bits go through 64-bit calls.
    by_kind = {}
    for variable, value in values:
        kind = "Integer" if variable.kind == "Enumeration" else variable.kind
        kind = "Long" if kind == "Integer" and not -(2**31) <= value < 2**31 else kind
        by_kind.setdefault(kind, []).append((variable, value))
    for kind, pairs in by_kind.items():
        variables, numbers = zip(*pairs, strict=True)
        if kind in ("String", "Binary"):
            slave.set_strings(variables, numbers)
            continue
        try:
            buffer = np.array(numbers, dtype=BUFFER_TYPES[kind])
        except OverflowError:
            raise SlaveError(
                f"{variables[0].name} cannot be {numbers[0]}: it has more than 63 bits."
            ) from None
        slave.check(f"Set{kind}", slave.setter(kind, variables, buffer)())
