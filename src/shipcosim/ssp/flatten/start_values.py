"""Bring parameter values to their variables, in the FMU's unit and type.

Order, as the standard has it: a component's own bindings first, then those of the systems around it from the inside
out, then sets given for this run; at one level in the order of the file. Later values replace earlier ones.
"""

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace
from difflib import get_close_matches

from shipcosim.errors import LONGEST_NAME, MOST_COMPARED, it_has, shortened, suggestion
from shipcosim.ssp.flatten.conversions import Flow, advance
from shipcosim.ssp.flatten.hierarchy import ElementPath, Hierarchy
from shipcosim.ssp.flatten.ports import SOURCES_INSIDE, Key, Port, Setting, Wire, variable_port
from shipcosim.ssp.flatten.swapped import WHERE
from shipcosim.ssp.fmu.description import Variable
from shipcosim.ssp.xml.document import Findings
from shipcosim.ssp.xml.values import Value
from shipcosim.units import Unit

SHORT = 2  # characters of a name of which a slip and another name look alike

Arrival = tuple[Value, Flow, "Wire | Setting", Key]
"""A value on its way to a component: original value, conversions so far, next step and target."""


class Settings:
    """Values that parameter sets give to the components' variables.

    Parameters
    ----------
    tree : Hierarchy
        With its ports, wires and settings.
    findings : Findings
        Takes what is wrong.

    Attributes
    ----------
    start : dict of path to dict of variable to value
        For the components' variables, in the FMU's unit and type.
    tolerances : dict of path to dict of variable to float
        Of those of them that have one, in the FMU's unit.
    system_start : dict of str to value
        For the outermost system's own connectors, in the connector's unit.
    """

    def __init__(self, tree: Hierarchy, findings: Findings):
        self.tree = tree
        self.findings = findings
        self.start = defaultdict(dict)
        self.tolerances = defaultdict(dict)
        self.system_start = {}
        self.tolerance = None  # of the value that is being delivered
        self.origin: tuple[ElementPath, str] = (), ""  # of that value: element and file
        # Where the present start values come from: a second value from there is no override of one level by another.
        self.origins: dict[Key, tuple[ElementPath, str]] = {}
        # Wires by their source: values set on a system connector go on along them.
        self.outgoing = defaultdict(list)
        for wire in tree.wires:
            self.outgoing[wire.source].append(wire)
        self.named = self._names()
        # Components that could not be read: an error says so, and their values say nothing new.
        self.unread = tuple(
            f"{'.'.join(path)}." for path, (_, fmu) in tree.components.items() if fmu is None
        )
        self.unused: dict[
            str, list[str]
        ] = {}  # of components that run another FMU: parameters which it does not have
        # Values for elements that do not exist, by file and element: one remark for all of them.
        self.astray: dict[tuple[str, str], list[str]] = defaultdict(list)
        # Values with a unit for ports without one, "NAME in UNIT" by file and place: one remark for each file.
        self.of_unknown_unit: dict[str, dict[str, str]] = defaultdict(dict)

    def _names(self) -> dict[str, list[Key]]:
        """Ports by full name; where element names have dots a name may mean several ports."""
        named = defaultdict(list)
        for path, (_, fmu) in self.tree.components.items():
            for name in () if fmu is None else fmu.variables:
                named[".".join((*path, name))].append(Key(path, name))
        for key, port in self.tree.ports.items():
            if port.owner == "system":
                named[".".join((*key.path, key.name))].append(key)
        return named

    def apply(self) -> None:
        """Bring every value to its variables."""
        # In order of application: later values replace earlier ones.
        for setting in self.tree.settings:
            keys = self.named.get(".".join((*setting.path, setting.name)), ())
            if not keys:
                self._unknown(setting)
            value = setting.value
            flow = Flow(value.kind, value.unit)
            self.tolerance = value.tolerance
            self.origin = setting.path, value.place.partition(", line")[0]
            for key in keys:
                self._deliver(value.value, flow, setting, key, value.place)
        for name, unused in self.unused.items():
            message = f"{self.tree.swapped[name].name} takes its place and has no {', '.join(dict.fromkeys(unused))}."
            self.findings.remark(f"{WHERE}, {name}", message, "These values are not used.")
        self._remark_left_out()
        for taken in self.of_unknown_unit.values():
            numbers = shortened(taken.values())
            message = f"Taken as numbers, since no unit is stated where they go: {numbers}."
            self.findings.remark(next(iter(taken)), message, "State it in the FMU or connector.")
        for (_, element), places in self.astray.items():
            what = "the value is" if len(places) == 1 else f"its {len(places)} values are"
            message = f"There is no element '{element}' in this system; {what} not used."
            self.findings.remark(places[0], message)

    def _remark_left_out(self) -> None:
        """Remark the values that mappings leave out, once for each file, unless another binding uses them."""
        used = {setting.value.place for setting in self.tree.settings}
        files: dict[str, dict[str, str]] = defaultdict(dict)
        for place, name in self.tree.left_out.items():
            if place not in used:
                files[place.partition(", line")[0]][place] = name
        for unused in files.values():
            self.findings.remark(
                next(iter(unused)), f"No mapping names {shortened(unused.values())}; not used."
            )

    def _deliver(
        self, value: Value, flow: Flow, step: Wire | Setting, key: Key, place: str
    ) -> None:
        """Take a value over a step to a port and onwards; once to each port, also in a circle."""
        # A parameter of a system may feed several components through nested systems.
        ahead = [(value, flow, step, key)]
        seen = set()
        while ahead:
            *arriving, key = ahead.pop()
            if key not in seen:
                seen.add(key)
                ahead += self._arrive(*arriving, key, place)

    def _arrive(
        self, value: Value, flow: Flow, step: Wire | Setting, key: Key, place: str
    ) -> Iterable[Arrival]:
        """Next steps of a value that has arrived at a port."""
        port = self._port(key)
        # The name of an item becomes a number at the first port that knows the items.
        if flow.type == "Enumeration" and isinstance(value, str):
            value, flow, step = self._number(value, flow, step, port, place)
            if value is None:
                return ()
        n_errors = len(self.findings.errors)
        flow = advance(flow, step, port, (place, ("the value", str(key))), self.findings)
        # A value that does not fit goes no further: a text cannot be converted.
        if len(self.findings.errors) > n_errors:
            return ()
        # At a component the way ends: convert and store.
        if port.owner == "component":
            self._start(value, flow, key, port, place)
            return ()
        # An output of a system has no effect on what is inside.
        if port.owner == "system" and port.kind not in SOURCES_INSIDE:
            self.findings.remark(
                place, f"{key} is of kind {port.kind}; a start value there has no effect."
            )
            return ()
        # The outermost system keeps the value itself, as the start of its input.
        if key.path == () and port.owner == "system":
            self.system_start[key.name] = self._in_unit(flow, port.unit, key, place)(value)
        return [(value, flow, wire, wire.target) for wire in self.outgoing[key]]

    def _port(self, key: Key) -> Port:
        if key in self.tree.ports:
            return self.tree.ports[key]
        _, fmu = self.tree.components[key.path]
        assert fmu is not None  # only variables of known FMUs have a name
        return variable_port(fmu.variables[key.name], fmu, "")

    def _number(
        self, value: str, flow: Flow, step: Wire | Setting, port: Port, place: str
    ) -> tuple[Value | None, Flow, Wire | Setting]:
        """Number of an enumeration's item, at the first port that knows its items.

        None with an error where there is no such item.
        """
        if not port.items:
            return value, flow, step
        # A mapping by names acts before the number is known, and is used up by it.
        table = step.transformation.table if step.transformation else {}
        name = table.get(value, value)
        if name not in port.items:
            self.findings.error(
                place, f"The enumeration has no item '{name}'.", it_has(name, port.items)
            )
        step = replace(step, transformation=None)
        return port.items.get(name), replace(flow, items=port.items), step

    def _in_unit(self, flow: Flow, unit: Unit | None, key: Key, place: str) -> Flow:
        """The value's way in the unit of its port; a port without one is noted, since any number may be meant."""
        if unit is None and flow.unit is not None and flow.unit.name not in ("1", "-"):
            self.of_unknown_unit[place.partition(", line")[0]][place] = f"{key} in {flow.unit.name}"
        return flow.in_unit(unit)

    def _start(self, value: Value, flow: Flow, key: Key, port: Port, place: str) -> None:
        variable = port.variable
        if variable is None:
            return  # its FMU is missing, which is an error already
        # FMI lets parameters and inputs be set, not calculated variables.
        if not variable.settable:
            self.findings.error(
                place,
                f"{key} is of causality {variable.causality}, a value that the FMU calculates.",
                "Set parameters and inputs.",
            )
            return
        # Convert to the FMU's own unit, then check its bounds.
        convert = self._in_unit(flow, port.variable_unit or port.unit, key, place)
        if check_bounds(convert(value), variable, place, str(key), self.findings):
            # In the order of application: of two names of one variable the last one set holds.
            earlier = self.start[key.path].pop(key.name, None)
            latest = self.start[key.path][key.name] = convert(value)
            if earlier not in (None, latest) and self.origins[key] == self.origin:
                self.findings.remark(
                    place,
                    f"{key} has got {earlier} from here already; {latest} is used.",
                    "Keep one of them.",
                )
            self.origins[key] = self.origin
            self.tolerances[key.path].pop(key.name, None)
            # The tolerance is a difference: the offset of the unit must not enter.
            if self.tolerance is not None and type(value) in (
                int,
                float,
            ):  # a text or a truth has none
                self.tolerances[key.path][key.name] = abs(
                    convert(value + self.tolerance) - convert(value)
                )

    def _unknown(self, setting: Setting) -> None:
        """Report an unknown name: an error if it looks like a slip, else a remark."""
        place = setting.value.place
        name = setting.name
        if ".".join((*setting.path, name)).startswith(self.unread):
            return
        # The standard lets a set hold more than is used. A misspelt name must not pass silently,
        # though.
        element, names = self._nearest(setting)
        # A swapped FMU may lack parameters of the original; they are listed in one remark.
        if element is not None and element in self.tree.swapped:
            self.unused.setdefault(element, []).append(name.removeprefix(f"{element}."))
            return
        if element is not None:
            message = f"{element} has no parameter '{name}'."
            # True if a parameter's name looks like a misspelt one of those that there are: part by part the same or
            # close.
            parts = name.split(".")
            candidates = [
                candidate.split(".")
                for candidate in list(names)[:MOST_COMPARED]
                if candidate.count(".") == len(parts) - 1
            ]
            is_slip = any(all(map(_is_close, parts, others)) for others in candidates)
            if is_slip:
                self.findings.error(place, message, it_has(name, names))
            else:
                self.findings.flaw(place, f"{message} The value is not used.", it_has(name, names))
            return
        elements = sorted({key.split(".")[0] for key in names})
        first = name.split(".")[0]
        close = get_close_matches(first, elements, n=1, cutoff=0.8)
        if close and not _differ_in_number(first, close[0]):
            self.findings.error(
                place, f"There is no element '{first}'.", suggestion(first, elements)
            )
        else:
            self.astray[place.partition(", line")[0], first].append(place)

    def _nearest(self, setting: Setting) -> tuple[str | None, list[str]]:
        """Element that a name means, by the longest existing path, and the names inside it."""
        start = "".join(f"{part}." for part in setting.path)
        names = [name.removeprefix(start) for name in self.named if name.startswith(start)]
        # A set bound to a component: all its names should be known there.
        if setting.near and setting.path in self.tree.components:
            if self.tree.components[setting.path][1] is None:
                return None, names
            return ".".join(setting.path), self._settable(names, start)
        parts = setting.name.split(".")
        # Otherwise try the longest prefix first.
        for n in range(len(parts) - 1, 0, -1):
            prefix = ".".join(parts[:n]) + "."
            inside = [name for name in names if name.startswith(prefix)]
            if inside:
                return start + prefix[:-1], self._settable(inside, start)
        return None, names

    def _settable(self, names: Iterable[str], start: str) -> list[str]:
        ports = {name: self._port(self.named[start + name][0]) for name in names}
        return [
            name for name, port in ports.items() if port.variable is None or port.variable.settable
        ]


def _is_close(first: str, other: str) -> bool:
    """True if a part of a name may stand for another; very short ones always may."""
    if first == other or max(len(first), len(other)) <= SHORT:
        return True
    near = len(first) < LONGEST_NAME and get_close_matches(first, [other], n=1)
    return bool(near) and not _differ_in_number(first, other)


def _differ_in_number(first: str, other: str) -> bool:
    """True if two names differ only in a number: ``thruster_1`` and ``thruster_2``."""
    return re.sub(r"\d+", "", first).strip("_") == re.sub(r"\d+", "", other).strip("_")


def check_bounds(
    value: Value, variable: Variable, place: str, name: str, findings: Findings
) -> bool:
    """True if a variable can have a value, else an error.

    Parameters
    ----------
    value : value
        In the variable's unit.
    variable : Variable
        Has the bounds or the items of its enumeration.
    place, name : str
        Where the value stands and what it is for, for messages.
    findings : Findings
        Takes what is wrong.
    """
    if variable.items and value not in variable.items.values():
        findings.error(place, f"{name} cannot be {value}.", f"Items: {dict(variable.items)}.")
        return False
    low = variable.minimum
    high = variable.maximum
    if (low is not None and value < low) or (high is not None and value > high):
        bounds = (
            f"at least {low:g}"
            if high is None
            else f"at most {high:g}"
            if low is None
            else f"{low:g} to {high:g}"
        )
        unit = f" {variable.unit}" if variable.unit else ""
        findings.error(place, f"{name} cannot be {value:.10g}{unit}.", f"Allowed: {bounds}{unit}.")
        return False
    return True
