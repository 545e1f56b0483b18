"""A system ready to run: flat, checked, with values in the units of the FMUs."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from shipcosim.errors import Problem, ShipcosimError, it_has, suggestion
from shipcosim.ssp.flatten.connections import Connection
from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.read.package import Package
from shipcosim.ssp.read.structure import End, Experiment
from shipcosim.ssp.xml.values import Value
from shipcosim.units import Unit, find_unit


@dataclass(frozen=True)
class Component:
    """A component of a system: an FMU with its start values.

    Parameters
    ----------
    name : str
        With the names of the systems around it before it: ``"ship.vessel"``.
    fmu : FmuDescription
        Its FMU; several components can share one.
    start : mapping of str to value
        Start values that the system sets, in the FMU's unit and type; the others stay as the FMU has them.
    step_size : float or None
        The step that an annotation asks for; None: the base step. [s]
    implementation : str
        ``"any"``, ``"CoSimulation"`` or ``"ModelExchange"``.
    tolerances : mapping of str to float
        Standard deviations within which start values count as known, where the system says so, in the FMU's unit.
    """

    name: str
    fmu: FmuDescription
    start: Mapping[str, Value] = field(default_factory=dict)
    step_size: float | None = None
    implementation: str = "any"
    tolerances: Mapping[str, float] = field(default_factory=dict)

    @property
    def variables(self) -> Mapping[str, Variable]:
        """Variables of its FMU, by name."""
        return self.fmu.variables

    def start_value(self, variable: str) -> Value | None:
        """Start value of a variable: the system's, else the FMU's own, else None."""
        return self.start.get(variable, self.variables[variable].start)

    @property
    def left_out(self) -> list[str]:
        """Parameters that the FMU must be given and the system does not set."""
        items = self.variables.items()
        return [
            name for name, v in items if v.required and self.start.get(name, v.start) == v.start
        ]


@dataclass(frozen=True)
class Signal:
    """A connector of the outermost system.

    Parameters
    ----------
    name, type, unit, description : str
        Type and unit are those of the variables behind it where the SSD leaves them open; unit may be None.
    start : value or None
        In `unit`. None: no value is set or derived, and the components' own start values hold until something feeds it.
    items : mapping of str to int
        Of an enumeration.
    """

    name: str
    type: str | None
    unit: str | None = None
    description: str = ""
    start: Value | None = None
    items: Mapping[str, int] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        """Kind of its values, as of a variable; empty where nothing says it."""
        return self.type or ""


@dataclass(frozen=True)
class System:
    """A system that a master can execute without looking at any file but the FMUs.

    FMUs unpacked from an .ssp stay on disk as long as the system (or one made from it) is referred to.

    Parameters
    ----------
    name : str
        Of the system structure.
    file : str
        Where it was read from.
    components : mapping of str to Component
        By full name, in the order of the file.
    connections : tuple of Connection
        From variable to variable.
    inputs, outputs, parameters : mapping of str to Signal
        Connectors of the outermost system.
    experiment : Experiment
        Default start, stop and step.
    remarks : tuple of Problem
        What a user should know although it stops nothing.
    given : tuple of Connection
        From parameters of the outermost system to variables; the start values follow them already.
    swapped : mapping of str to str
        Components that run another FMU than the system structure says, and its file.
    """

    name: str
    file: str
    components: Mapping[str, Component]
    connections: tuple[Connection, ...] = ()
    inputs: Mapping[str, Signal] = field(default_factory=dict)
    outputs: Mapping[str, Signal] = field(default_factory=dict)
    parameters: Mapping[str, Signal] = field(default_factory=dict)
    experiment: Experiment = Experiment()
    remarks: tuple[Problem, ...] = ()
    given: tuple[Connection, ...] = ()
    swapped: Mapping[str, str] = field(default_factory=dict)
    _packages: tuple[Package, ...] = field(
        default=(), repr=False, compare=False
    )  # keeps what was unpacked on disk

    @property
    def deviations(self) -> list[Problem]:
        """Remarks on what a run does otherwise than the files ask; `check` names free inputs as well."""
        return [
            remark for remark in self.remarks if remark.flaw or remark.where not in self.components
        ]

    def __repr__(self) -> str:
        counts = f"{len(self.components)} components, {len(self.connections)} connections"
        return f"<System {self.name!r}: {counts}>"

    @property
    def feeding(self) -> dict[End, End]:
        """Source of each connected input or parameter, by its target."""
        return {connection.target: connection.source for connection in self.connections}

    def all_variables(self) -> Iterator[tuple[Component, Variable]]:
        """Every variable, after its component, in the order of system and FMUs."""
        for component in self.components.values():
            for variable in component.variables.values():
                yield component, variable

    def split(self, signal: str, where: str = "") -> End:
        """Component and variable that a signal's name means.

        Parameters
        ----------
        signal : str
            ``component.variable``, or a connector of the outermost system alone.
        where : str
            Where the name stands, for messages.

        Returns
        -------
        tuple of (str or None, str)
            None for a connector of the outermost system.

        Raises
        ------
        ShipcosimError
            If there is no such signal.
        """
        if any(signal in group for group in (self.inputs, self.outputs, self.parameters)):
            return None, signal
        # Names of components may contain dots: the longest one that fits wins.
        owners = [name for name in self.components if signal.startswith(f"{name}.")]
        for name in sorted(owners, key=len, reverse=True):
            if signal[len(name) + 1 :] in self.components[name].variables:
                return name, signal[len(name) + 1 :]
        raise ShipcosimError(self._no_signal(signal, owners, where))

    def described(self, component: str | None, name: str) -> Variable | Signal:
        """A variable, or a connector of the outermost system, as `split` names them."""
        if component is not None:
            return self.components[component].variables[name]
        return {**self.inputs, **self.outputs, **self.parameters}[name]

    def unit_of(self, component: str | None, name: str) -> Unit | None:
        """Unit of what `split` names; None without one."""
        unit = self.described(component, name).unit or None
        return find_unit(unit, {} if component is None else self.components[component].fmu.units)

    def start_value(self, component: str | None, name: str) -> Any:
        """Start value of what `split` names; None without one."""
        if component is not None:
            return self.components[component].start_value(name)
        return self.described(None, name).start

    def _no_signal(self, signal: str, owners: list[str], where: str) -> Problem:
        if owners:
            owner = max(owners, key=len)
            variable = signal[len(owner) + 1 :]
            choices = self.components[owner].variables
            return Problem(
                where, f"{owner} has no variable '{variable}'.", it_has(variable, choices)
            )
        element = signal.split(".")[0]
        choices = [*self.components, *self.inputs, *self.outputs, *self.parameters]
        return Problem(
            where, f"There is no component or connector '{element}'.", suggestion(element, choices)
        )


def alias_remarks(
    components: Mapping[str, Component], connections: Iterable[Connection]
) -> list[Problem]:
    """A remark where two names of one variable of an FMU get two values: which of them is used.

    Parameters
    ----------
    components : mapping of str to Component
        With their start values in the order in which they are set.
    connections : iterable of Connection
        Their values are set after the start values: parameters once, inputs in every step.
    """
    fed = {connection.target: connection.initial for connection in connections}
    remarks = []
    for component in components.values():
        # Values by variable, in the order in which the FMU gets them; a connection's is not known.
        given: dict[str, Any] = dict(component.start)
        for is_initial in (True, False):
            for name in component.variables:
                if fed.get((component.name, name)) is is_initial:
                    given.pop(name, None)
                    given[name] = f"the value that is connected to {name}"
        names: dict[tuple, dict[str, Any]] = defaultdict(dict)
        for name, value in given.items():
            variable = component.variables[name]
            kind = "Integer" if variable.kind == "Enumeration" else variable.kind
            if variable.negated and not isinstance(value, str):
                value = -value
            names[kind, variable.value_reference, variable.place][name] = value
        for (_, reference, _), values in names.items():
            if len(set(values.values())) > 1:
                *others, used = values
                message = (
                    f"{', '.join(others)} and {used} are one variable of its FMU (value reference {reference})"
                    f" and get different values; that of {used} is used."
                )
                where = f"{component.name}.{used}"
                remarks.append(Problem(where, message, "Give one of them.", "remark"))
    return remarks
