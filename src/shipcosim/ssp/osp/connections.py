"""Connections of an OspSystemStructure.xml: of variables, of variable groups, and through functions."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import lxml.etree as etree

from shipcosim.errors import it_has, suggestion
from shipcosim.ssp.flatten.connections import Connection
from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.osp.functions import Function, Wiring
from shipcosim.ssp.osp.groups import Group, file_names, read_groups
from shipcosim.ssp.osp.simulators import Simulators
from shipcosim.ssp.read.structure import label
from shipcosim.ssp.xml.document import Document, Findings, local, parts_in
from shipcosim.units import find_unit, relation, told_apart

SOURCES = ("output", "calculatedParameter")
"""Causalities of variables that a connection can start from."""

End = tuple[str, str]
"""Simulator and variable."""


class ConnectionReader:
    """Reads the connections of a document.

    Parameters
    ----------
    document : Document
        The OspSystemStructure.xml, which keeps its schema.
    simulators : Simulators
        All of them.
    functions : mapping of str to Function
        By name.
    findings : Findings
        Takes what is wrong.

    Attributes
    ----------
    connections : list of Connection
        From variable to variable; several into one target are a sum.
    """

    def __init__(
        self,
        document: Document,
        simulators: Simulators,
        functions: Mapping[str, Function],
        findings: Findings,
    ):
        self.document = document
        self.simulators = simulators
        self.functions = functions
        self.findings = findings
        self.connections: list[Connection] = []
        self.wiring = Wiring(functions, findings)
        self._groups: dict[Path, dict[str, Group] | None] = {}
        self._fed: dict[
            tuple[str | None, str], tuple[str, ...]
        ] = {}  # where what feeds a target comes from

    def read(self, elements: Iterable[etree._Element]) -> list[Connection]:
        """Read connection elements; wrong ones are left out, with an error."""
        kinds = {"Signal": self._signal, "SignalGroup": self._signal_group}
        for element in elements:
            # Both ends of a connection, in the order of the file.
            ends = {local(part): part for part in parts_in(element)}
            shown = " - ".join(
                f"{part.get('simulator') or part.get('function')}.{part.get('name')}"
                for part in parts_in(element)
            )
            place = self.document.place(element, shown)
            if element.get("powerBond"):
                self.findings.remark(
                    place, "powerBond is not used: it is for the algorithm ecco alone."
                )
            # One end is a signal of a function, or both ends are variables or groups.
            if kind := next((name for name in kinds if name in ends), None):
                variable = ends["Variable" if kind == "Signal" else "VariableGroup"]
                kinds[kind](variable, ends[kind], place)
            else:
                first, other = parts_in(element)
                self._pair(first, other, place)
        # Connections through functions follow once all their signals are known.
        for signal, connection in self.wiring.connections():
            self._add(connection, signal)
        return self.connections

    def _pair(self, first: etree._Element, other: etree._Element, place: str) -> None:
        """A connection of two variables, or of the variables of two groups one by one."""
        if local(first) == "Variable":
            ends = [end for part in (first, other) if (end := self._end(part, place)) is not None]
            if len(ends) == 2:
                self._direct(ends[0], ends[1], place)
            return
        groups = [
            group for part in (first, other) if (group := self._group(part, place)) is not None
        ]
        if len(groups) == 2:
            self._join(groups, [first.get("simulator"), other.get("simulator")], place)

    def _join(self, groups: Sequence[Group], simulators: Sequence[str], place: str) -> None:
        """Connect two groups in order: their inner groups, then their variables."""
        # Groups must have the same number of variables and inner groups.
        counts = [(len(group.variables), len(group.groups)) for group in groups]
        if counts[0] != counts[1]:
            names = [
                f"{simulator}.{group.name}"
                for simulator, group in zip(simulators, groups, strict=True)
            ]
            message = f"{names[0]} has {_counted(*counts[0])}, {names[1]} {_counted(*counts[1])}."
            self.findings.error(place, message, "Connect groups of one make.")
            return
        # Kinds may differ, as long as the numbers agree.
        if groups[0].kind != groups[1].kind:
            message = f"A {groups[0].kind} is connected to a {groups[1].kind}, one variable after the other."
            self.findings.remark(place, message)
        for inner in zip(groups[0].groups, groups[1].groups, strict=True):
            self._join(inner, simulators, place)
        for pair in zip(groups[0].variables, groups[1].variables, strict=True):
            ends = list(zip(simulators, pair, strict=True))
            if all(self._has(end) for end in ends):
                self._direct(ends[0], ends[1], place)

    def _direct(self, first: End, other: End, place: str) -> None:
        """Add a connection in the direction that the causalities give."""
        source, target = (
            (first, other) if self._variable(first).causality in SOURCES else (other, first)
        )
        self._add(Connection(source, target, place=place))

    def _add(self, connection: Connection, signal: tuple[str, str] | None = None) -> None:
        """Add a connection; `signal` is its function signal, which may sum several."""
        # Names and causalities of both ends.
        source, target = (self._variable(end) for end in (connection.source, connection.target))
        names = [label(end) for end in (connection.source, connection.target)]
        place = connection.place
        # An input takes one connection, or the terms of one sum.
        feeding = self._fed.get(connection.target)
        self._fed[connection.target] = signal or (place,)
        if source.causality not in SOURCES or target.causality != "input":
            message = (
                f"{names[0]} is of causality {source.causality}, {names[1]} {target.causality}."
            )
            self.findings.error(place, message, "A connection leads from an output to an input.")
        elif source.kind != target.kind or (signal and target.kind != "Real"):
            message = f"{names[0]} is {source.kind}, {names[1]} is {target.kind}."
            remedy = "Functions take and give Real alone." if signal else "Connect equal types."
            self.findings.error(place, message, remedy)
        elif feeding is not None and feeding != signal:
            self.findings.error(
                place, f"A second connection into {names[1]}.", "Remove one of them."
            )
        else:
            # Functions convert on purpose; plain connections in other units deserve a remark.
            if not connection.is_linear:
                self._compare_units(connection, names)
            self.connections.append(connection)

    def _compare_units(self, connection: Connection, names: Sequence[str]) -> None:
        # OSP converts no units: differing units are a likely mistake.
        units = []
        for name, variable in (connection.source, connection.target):
            fmu = self._fmu(name)
            units.append(find_unit(fmu.variables[variable].unit, fmu.units))
        if None not in units and relation(units[0], units[1]) in ("convertible", "incompatible"):
            source, target = told_apart(units[0], units[1])
            self.findings.remark(
                connection.place,
                f"{names[0]} is in {source}, {names[1]} in {target}: OSP converts no units.",
                "Put a LinearTransformation between them.",
            )

    def _signal(self, variable: etree._Element, signal: etree._Element, place: str) -> None:
        end = self._end(variable, place)
        if self._has_function(signal, place):
            self.wiring.take(signal.get("function"), signal.get("name"), end, place)

    def _signal_group(self, group: etree._Element, signal: etree._Element, place: str) -> None:
        # Both the group and the function's group must exist, with the same number of signals.
        named_group = self._group(group, place)
        if not self._has_function(signal, place):
            return
        function = self.functions[signal.get("function")]
        name = signal.get("name")
        if name not in function.groups:
            text = f"The {function.kind} '{function.name}' has no group of signals '{name}'."
            self.findings.error(place, text, it_has(name, function.groups))
            return
        if named_group is None:
            self.wiring.give_up(function.name)
            return
        if len(named_group.variables) != function.dimension:
            self.wiring.give_up(function.name)
            text = f"{group.get('simulator')}.{named_group.name} has {_counted(len(named_group.variables), 0)}, "
            self.findings.error(place, f"{text}{function.name} the dimension {function.dimension}.")
            return
        # Each variable of the group feeds the signal of the same number.
        for j, variable in enumerate(named_group.variables):
            end = group.get("simulator"), variable
            self.wiring.take(function.name, f"{name}[{j}]", end if self._has(end) else None, place)

    def _has_function(self, signal: etree._Element, place: str) -> bool:
        name = signal.get("function")
        if name not in self.functions:
            self.findings.error(
                place, f"There is no function '{name}'.", suggestion(name, self.functions)
            )
        return name in self.functions

    def _group(self, element: etree._Element, place: str) -> Group | None:
        # Groups of each FMU are read once.
        simulator = element.get("simulator")
        name = element.get("name")
        fmu = self.simulators.fmu_of(simulator, place)
        if fmu is None:
            return None
        if fmu.path not in self._groups:
            self._groups[fmu.path] = read_groups(fmu, self.document.folder, self.findings)
        groups = self._groups[fmu.path]
        if groups is None:
            self.findings.error(
                place,
                f"The variable groups of {fmu.path.name} are described nowhere.",
                f"Put {file_names(fmu)[0]} beside it.",
            )
        elif name not in groups:
            self.findings.error(
                place, f"{simulator} has no variable group '{name}'.", it_has(name, groups)
            )
        return (groups or {}).get(name)

    def _end(self, element: etree._Element, place: str) -> End | None:
        """(simulator, variable) of an end, or None with an error."""
        simulator = element.get("simulator")
        name = element.get("name")
        fmu = self.simulators.fmu_of(simulator, place)
        if fmu is None:
            return None
        if name not in fmu.variables:
            self.findings.error(
                place, f"{simulator} has no variable '{name}'.", it_has(name, fmu.variables)
            )
            return None
        return simulator, name

    def _fmu(self, simulator: str | None) -> FmuDescription:
        """FMU of a simulator."""
        fmu = self.simulators.tree.components[simulator or "",][1]
        assert fmu is not None  # ends of connections without one were refused
        return fmu

    def _variable(self, end: tuple[str | None, str]) -> Variable:
        return self._fmu(end[0]).variables[end[1]]

    def _has(self, end: End) -> bool:
        return end[1] in self._fmu(end[0]).variables


def _counted(variables: int, groups: int) -> str:
    text = f"{variables} variable{'s' * (variables != 1)}"
    return text + (f" and {groups} group{'s' * (groups != 1)}" if groups else "")
