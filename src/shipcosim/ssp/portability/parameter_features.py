"""Parameter sets and values that other tools read differently.

Each function takes a Subject and yields (place, description); an empty text: the feature's words.
"""

import lxml.etree as etree

from shipcosim.ssp.portability.subject import Found, Subject, is_fmi_1, types_of_2
from shipcosim.ssp.xml.document import local
from shipcosim.units import find_unit, relation


def sets_on_systems(subject: Subject) -> Found:
    """A parameter set bound to a system."""
    if subject.structure is not None:
        system = subject.structure.system
        yield from ((binding.values.place or system.place, "") for binding in system.bindings)


def several_sets(subject: Subject) -> Found:
    """A second parameter set on a component."""
    for part in subject.components:
        yield from ((binding.values.place, "") for binding in part.bindings[1:])


def set_names(subject: Subject) -> Found:
    """A parameter set."""
    names = dict.fromkeys(values.name for *_, values in subject.sets)
    if names and subject.structure is not None:
        yield subject.structure.system.place, f"parameter sets {', '.join(map(repr, names))}"


def sets_of_other_names(subject: Subject) -> Found:
    """Parameter sets of different names."""
    sets = list(subject.sets)
    for part, _, _, values in sets:
        if values.name != sets[0][-1].name:
            yield part.place, f"the parameter set '{values.name}' beside '{sets[0][-1].name}'"


def set_prefixes(subject: Subject) -> Found:
    """A prefix of a binding."""
    for part in subject.components:
        yield from ((binding.values.place, "") for binding in part.bindings if binding.prefix)


def set_mappings(subject: Subject) -> Found:
    """A parameter mapping (SSM)."""
    for part in subject.components:
        yield from (
            (binding.mapping.place, "") for binding in part.bindings if binding.mapping is not None
        )


def sets_in_fmus(subject: Subject) -> Found:
    """A parameter set inside an FMU."""
    for part in subject.components:
        yield from (
            (binding.values.place, "") for binding in part.bindings if binding.values.in_component
        )


def set_units(subject: Subject) -> Found:
    """A value in another unit than the FMU's."""
    # Only convertible units can change a value.
    for value, variable, fmu in subject.values:
        own_unit = find_unit(variable.unit, fmu.units)
        if (
            value.unit is not None
            and own_unit is not None
            and relation(value.unit, own_unit) == "convertible"
        ):
            yield value.place, f"a value in {value.unit.name}, where the FMU has {own_unit.name}"


def set_enumerations(subject: Subject) -> Found:
    """A value of type Enumeration."""
    for *_, values in subject.sets:
        yield from ((value.place, "") for value in values.values if value.kind == "Enumeration")


def values_of_2(subject: Subject) -> Found:
    """A value of a type of SSP 2.0."""
    for document in subject.documents:
        for part in document.root.iter(etree.Element):
            if local(part) == "Parameter":
                what = f"a value of type {types_of_2(part)[0]}" if types_of_2(part) else None
                yield from [(document.place(part, part.get("name")), what)] if what else ()


def values_for_fmi_1(subject: Subject) -> Found:
    """A value for a parameter of an FMU of FMI 1.0."""
    for value, variable, fmu in subject.values:
        if is_fmi_1(fmu) and variable.causality == "parameter":
            yield value.place, ""


def integers_for_reals(subject: Subject) -> Found:
    """An Integer value for a Real."""
    for value, variable, _ in subject.values:
        if (value.kind, variable.kind) == ("Integer", "Real"):
            yield value.place, ""


def values_of_others(subject: Subject) -> Found:
    """A value for a variable that is not a parameter or input."""
    for value, variable, _ in subject.values:
        if variable.causality not in ("parameter", "input"):
            yield value.place, f"a value for a variable of causality {variable.causality}"
