"""Contents of a system structure: elements, connections, default experiment; check and write."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Self

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.ssp.check import problems_of
from shipcosim.ssp.edit.draft import Draft
from shipcosim.ssp.edit.elements import element_named
from shipcosim.ssp.edit.experiment import experiment_time, set_experiment_time, write_step_size
from shipcosim.ssp.edit.names import connections, walk
from shipcosim.ssp.edit.start_values import StartValues
from shipcosim.ssp.flatten.hierarchy import Swapped
from shipcosim.ssp.flatten.system import Component, System
from shipcosim.ssp.read.parameters import ParameterSets
from shipcosim.ssp.xml.annotations import step_sizes
from shipcosim.ssp.xml.document import AnyPath, children


class SystemContents:
    """A system structure to look at, check and write.

    Parameters
    ----------
    draft : Draft
        Holds the XML.

    Attributes
    ----------
    parameters : MutableMapping of str to value
        Start values in the FMUs' units, to be read, set and deleted.
    """

    def __init__(self, draft: Draft):
        self._draft = draft
        self.parameters = StartValues(draft)

    @property
    def name(self) -> str:
        """Name of the system structure."""
        return self._draft.root.get("name", "")

    @property
    def description(self) -> str:
        """Description of the system in one line."""
        return self._draft.root.get("description", "")

    @description.setter
    def description(self, text: str) -> None:
        with self.changes():
            self._draft.root.set("description", text)

    @property
    def elements(self) -> list[str]:
        """Full names of all components, systems and signal dictionary references."""
        return [name for name, _ in walk(self._draft.system) if name]

    @property
    def parameter_sets(self) -> list[str]:
        """Sources of the parameter sets that the outermost system binds, in the order of the file."""
        bound = children(self._draft.system, "ssd:ParameterBindings", "ssd:ParameterBinding")
        return [part.get("source", "") for part in bound if part.get("source")]

    @property
    def components(self) -> dict[str, Component]:
        """Components with their FMUs' descriptions by full name, those in systems of other files included."""
        system = self._draft.assembled()[0]
        return {} if system is None else dict(system.components)

    @property
    def connections(self) -> list[tuple[str, str]]:
        """Names of the connectors that are joined, (source, target), in the order of the file."""
        return [ends for ends, _ in connections(self._draft.system)]

    def to_dot(self) -> str:
        """The system as a graph for Graphviz: an arrow from each element to what it feeds, with the inputs there."""
        fed: dict[tuple[str, str], list[str]] = {}
        for source, target in self.connections:
            ends = (source.rpartition(".")[0] or self.name, target.rpartition(".")[0] or self.name)
            fed.setdefault(ends, []).append(target.rpartition(".")[2])
        nodes = [f"  {json.dumps(name)};" for name in self.components]
        arrows = [
            f"  {json.dumps(start)} -> {json.dumps(end)} [label={json.dumps(', '.join(inputs))}];"
            for (start, end), inputs in fed.items()
        ]
        return "\n".join(["digraph {", "  node [shape=box];", *nodes, *arrows, "}"])

    def connectors(self, element: str = "") -> dict[str, str]:
        """Kinds of an element's connectors by their names; of the outermost system's, if none is named.

        Raises
        ------
        ShipcosimError
            If there is no such element.
        """
        listed = children(element_named(self._draft, element), "ssd:Connectors", "ssd:Connector")
        return {part.get("name", ""): part.get("kind", "") for part in listed}

    @property
    def start_time(self) -> float:
        """Where the default experiment starts. [s]"""
        return experiment_time(self._draft.root, "startTime") or 0.0

    @start_time.setter
    def start_time(self, time: float) -> None:
        with self.changes():
            set_experiment_time(self._draft.root, "startTime", time)

    @property
    def stop_time(self) -> float | None:
        """Where the default experiment ends, or None. [s]"""
        return experiment_time(self._draft.root, "stopTime")

    @stop_time.setter
    def stop_time(self, time: float) -> None:
        with self.changes():
            set_experiment_time(self._draft.root, "stopTime", time)

    @property
    def step_size(self) -> float | None:
        """Base step that an annotation gives, or None. Setting it writes OSP's, which libcosim needs. [s]"""
        return next(
            (float(part.get(name, "")) for part, name in step_sizes(self._draft.root)), None
        )

    @step_size.setter
    def step_size(self, step_size: float) -> None:
        with self.changes():
            write_step_size(self._draft.root, float(step_size))

    def check(self, parameters: ParameterSets = ()) -> list[Problem]:
        """Find everything that is wrong, and remarks; no binary is loaded.

        Parameters
        ----------
        parameters : path or ParameterSet, or iterable of them
            Applied over those of the system.

        Returns
        -------
        list of Problem
        """
        return problems_of(*self._draft.assemble(parameters))

    def checked(self, parameters: ParameterSets = (), components: Swapped = None) -> System:
        """The system ready to run, as `shipcosim.ssp.read_system` gives it.

        Parameters
        ----------
        parameters : path or ParameterSet, or iterable of them
            Applied over those of the system.
        components : mapping of str to Path, optional
            FMUs that components run in place of their own.

        Returns
        -------
        System

        Raises
        ------
        ShipcosimError
            With everything that is wrong.
        """
        system, findings = self._draft.assemble(parameters, components)
        if system is None or findings.errors:
            raise ShipcosimError(list(dict.fromkeys(findings.errors)))
        return system

    @contextmanager
    def changes(self) -> Iterator[Self]:
        """Take the changes of a ``with`` block as one: checked at its end, and all undone if something is wrong.

        Examples
        --------
        >>> from shipcosim.ssp import new
        >>> system = new("voyage")
        >>> with system.changes():
        ...     system.add_system("ship")
        ...     system.add_connector("ship.speed", "output", unit="m/s")
        >>> system.elements, system.connectors("ship")
        (['ship'], {'speed': 'output'})
        """
        with self._draft.changes():
            yield self

    def copy(self) -> Self:
        """Copy the system; both can then be changed independently."""
        return type(self)(self._draft.copy())

    def write(self, path: AnyPath, *, fmus: bool = True) -> None:
        """Write the system with all its files; unchanged parts stay byte by byte the same.

        Parameters
        ----------
        path : path
            Ends in .ssp: one packed file. In .ssd: an SSD, and beside it what it refers to. Else: a folder.
        fmus : bool
            Whether FMUs that were not in the package come along; a .ssp always has them.

        Raises
        ------
        ShipcosimError
            With everything that is wrong with the system, or if it cannot be written.
        """
        self.checked()
        self._draft.write(Path(path), fmus)
