"""Start values of an edited system, as a mapping of names to values in the FMUs' units."""

from collections.abc import Iterator, Mapping, MutableMapping
from dataclasses import replace
from math import isfinite
from typing import Any

from shipcosim.errors import ShipcosimError, suggestion
from shipcosim.ssp.edit.draft import Draft
from shipcosim.ssp.edit.parameter_sets import Bound
from shipcosim.ssp.edit.write import KIND_OF
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.read.parameters import ParameterValue, tolerance_of
from shipcosim.ssp.xml.definitions import read_units
from shipcosim.ssp.xml.document import children, qualified
from shipcosim.ssp.xml.markup import drop
from shipcosim.ssp.xml.values import Value
from shipcosim.units import Unit, as_python, conversion, find_unit, relation


class StartValues(MutableMapping[str, Value]):
    """Start values by full name: ``values["vessel.mass"]``.

    Every parameter, input and other variable with a start value can be read and, where it is settable, set; what the
    mapping has (``in``, ``len``, iteration) is what the system sets. ``del`` leaves a variable to its FMU again.

    Parameters
    ----------
    draft : Draft
        The system.
    """

    def __init__(self, draft: Draft):
        self._draft = draft

    def _system(self) -> System:
        system, findings = self._draft.assembled()
        if system is None:
            raise ShipcosimError(findings.errors)
        return system

    def __getitem__(self, name: str) -> Value | None:
        system = self._system()
        return system.start_value(*system.split(name))

    def __setitem__(self, name: str, value: Value) -> None:
        with self._draft.changes():
            self.put(name, value)

    def __delitem__(self, name: str) -> None:
        with self._draft.changes():
            was_there = self._draft.sets.clear(name)
            self._draft.reassembled()
            if not was_there or name in self:
                where = "It is set in a set that is bound more than once, or by a mapping."
                message, remedy = (
                    (where, "")
                    if name in self
                    else ("The system does not set it.", suggestion(name, self))
                )
                raise self._draft.error(name, message, remedy)

    def __iter__(self) -> Iterator[str]:
        system = self._system()
        bound = self._draft.sets.bound
        for name in {**system.inputs, **system.parameters}:
            if any(parameter_set.parameter(name) is not None for parameter_set in bound):
                yield name
        for component in system.components.values():
            yield from (f"{component.name}.{variable}" for variable in component.start)

    def __contains__(self, name: object) -> bool:
        return name in set(self)

    def __len__(self) -> int:
        return len(set(self))

    def __repr__(self) -> str:
        return repr(dict(self))

    def update(self, *values: Any, **named: Value) -> None:
        """Set several values and check them together, which is sooner done than one by one; as `dict.update`."""
        with self._draft.changes():
            self._put([self._given(name, value) for name, value in dict(*values, **named).items()])

    def put(
        self,
        name: str,
        value: Value,
        unit: str | None = None,
        description: str = "",
        tolerance: float | None = None,
    ) -> None:
        """Set a value in place or, without effect there, over all; see `SystemStructure.set`."""
        given = self._given(name, value, unit)
        self._put([replace(given, description=description, tolerance=tolerance)])

    def _given(self, name: str, value: Any, unit: str | None = None) -> ParameterValue:
        """A value in the type and unit of its variable, items of enumerations by name."""
        kind, own_unit, items = _target(self._system(), name)
        value = as_python(value)
        if kind == "Enumeration" and type(value) is int:
            value = next((item for item, number in items.items() if number == value), str(value))
        value = self._converted(name, value, unit, own_unit)
        kind = self._kind(name, value, kind)
        value = float(value) if kind == "Real" else value
        return ParameterValue(name, kind, value, own_unit if kind == "Real" else None)

    def _put(self, values: list[ParameterValue]) -> None:
        before = len(self._draft.assembled()[1].errors)
        for given in values:
            self._draft.sets.put(given.name, given)
        # Look whether the system now has these values: a mapping or a connector of a system has the last word.
        system, findings = self._draft.reassembled()
        if system is None or len(findings.errors) > before:
            return
        for given in values:
            wanted = _target(system, given.name)[2].get(given.value, given.value)
            if system.start_value(*system.split(given.name)) != wanted:
                self._draft.sets.append("", given.name, given)

    def bind_to_components(self) -> None:
        """See `SystemStructure.bind_to_components`."""
        # Collect all values before the bindings go: they may come from anywhere.
        system = self._system()
        bound = self._draft.sets.bound
        values = {name: _described(system, bound, name) for name in self}
        for binding in list(self._draft.root.iter(qualified("ssd:ParameterBinding"))):
            drop(binding)
        for name, value in values.items():
            self._draft.sets.put(name, value)
        for bound_set in self._draft.sets.bound:
            bound_set.root.set(
                "name", self._draft.root.get("name") or "values"
            )  # ecos applies the sets of one name alone

    def _kind(self, name: str, value: Value, kind: str | None) -> str:
        if type(value) not in KIND_OF:
            raise self._draft.error(
                name, f"{value!r} is no value.", "A value is a number, true or false, or a text."
            )
        if isinstance(value, float) and not isfinite(value):
            raise self._draft.error(name, f"{value} is not a finite number.")
        own_kind = KIND_OF[type(value)]
        fits = (own_kind, kind) in (("Integer", "Real"), ("String", "Enumeration"))
        return kind if fits and kind else own_kind

    def _converted(self, name: str, value: Value, unit: str | None, own_unit: Unit | None) -> Value:
        if unit is None:
            return value
        # Units of the SSD may have names of its own.
        given = find_unit(unit, read_units(children(self._draft.root, "ssd:Units", "ssc:Unit")))
        if (
            given is None
            or own_unit is None
            or relation(given, own_unit) in ("unknown", "incompatible")
        ):
            raise self._draft.error(
                name,
                f"A value in {unit}, but {name} is in {own_unit.name if own_unit else 'no unit'}.",
                "These cannot be converted.",
            )
        factor, offset = conversion(given, own_unit)
        return factor * value + offset


def _target(system: System, name: str) -> tuple[str, Unit | None, Mapping[str, int]]:
    """Type, unit and enumeration items of a signal."""
    end = system.split(name)
    target = system.described(*end)
    return target.kind, system.unit_of(*end), target.items


def _described(system: System, bound: list[Bound], name: str) -> ParameterValue:
    """Start value of a signal for a parameter set, with description and tolerance of its origin."""
    kind, unit, items = _target(system, name)
    value = system.start_value(*system.split(name))
    # Enumerations are written by item name.
    if kind == "Enumeration":
        value = next(item for item, number in items.items() if number == value)
    # The last set that has the parameter describes it.
    entries = [parameter_set.parameter(name) for parameter_set in bound]
    origin = next((part for part in reversed(entries) if part is not None), None)
    described: dict[str, Any] = {}
    if origin is not None:
        # A tolerance in another unit would be wrong.
        same_unit = unit is None or any(part.get("unit") == unit.name for part in origin)
        described = {"description": origin.get("description", "")}
        described["tolerance"] = tolerance_of(origin) if same_unit else None
    return ParameterValue(name, kind, value, unit if kind == "Real" else None, **described)
