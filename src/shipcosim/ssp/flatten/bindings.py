"""Parameter bindings: their values, under the names that prefixes and mappings give them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from shipcosim.errors import it_has
from shipcosim.ssp.flatten.array_elements import element_values
from shipcosim.ssp.flatten.hierarchy import ElementPath, Hierarchy, Surroundings
from shipcosim.ssp.flatten.ports import Setting
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.read.parameters import (
    MappingEntry,
    ParameterSet,
    ParameterValue,
    read_mapping,
    read_parameter_set,
)
from shipcosim.ssp.read.structure import Binding


def take_bindings(
    tree: Hierarchy,
    bindings: Iterable[Binding],
    path: ElementPath,
    place: Surroundings,
    near: bool = False,
    fmu: FmuDescription | None = None,
) -> None:
    """Collect the values that an element's bindings set.

    Parameters
    ----------
    tree : Hierarchy
        Takes what is found and what is wrong.
    bindings : iterable of Binding
        In the order in which they are applied.
    path : tuple of str
        Place of the element.
    place : Surroundings
        What addresses in the bindings start from.
    near : bool
        Whether the element is a component, all of whose names should be known.
    fmu : FmuDescription, optional
        Of the component; it can hold parameter sets itself.
    """
    for binding in bindings:
        document = tree.library.content(binding.values, place, fmu)
        if document is None:
            continue
        # Prefix and mapping are alternatives of renaming: the mapping refers to prefixed names.
        values = tree.library.parsed(read_parameter_set, document)
        mapping = None
        if binding.mapping is not None:
            content = tree.library.content(binding.mapping, place, fmu)
            mapping = () if content is None else tree.library.parsed(read_mapping, content)
        if mapping is None:
            tree.settings += _settings(tree, values, path, binding.prefix, near)
        else:
            tree.settings += _mapped(tree, values, path, binding.prefix, mapping)


def apply_set(tree: Hierarchy, values: ParameterSet) -> None:
    """Set the values of a parameter set on the outermost system, after all others.

    Parameters
    ----------
    tree : Hierarchy
        Takes the values.
    values : ParameterSet
        Given for this run.
    """
    tree.settings += _settings(tree, values, (), "", False)


def _settings(
    tree: Hierarchy, values: ParameterSet, path: ElementPath, prefix: str, near: bool
) -> list[Setting]:
    return [
        Setting(path, prefix + element_value.name, element_value, near=near)
        for value in values.values
        for element_value in element_values(value, tree.findings)
    ]


def _mapped(
    tree: Hierarchy,
    values: ParameterSet,
    path: ElementPath,
    prefix: str,
    mapping: Sequence[MappingEntry],
) -> list[Setting]:
    """Values under the names of a parameter mapping; values that it does not name are not used."""
    by_name = {prefix + value.name: value for value in values.values}
    settings = []
    # The mapping may convert the value too; the conversion happens on the way to the variable.
    templates = [entry for entry in mapping if not entry.source and "" not in by_name]
    if templates:
        tree.findings.flaw(
            templates[0].place,
            f"{len(templates)} entries of the mapping name no source; they are not used.",
            "Fill them in, or remove them.",
        )
    for entry in mapping:
        if entry in templates:
            continue
        if entry.source not in by_name:
            tree.findings.error(
                entry.place,
                f"The parameter set '{values.name}' has no '{entry.source}'.",
                it_has(entry.source, by_name),
            )
            continue
        how = (entry.transformation, entry.suppress_unit_conversion)
        renamed = replace(by_name[entry.source], name=entry.target)
        settings += [
            Setting(path, element_value.name, element_value, *how, near=True)
            for element_value in element_values(renamed, tree.findings)
        ]
    _remark_left_out(tree, by_name, path, mapping)
    return settings


def _remark_left_out(
    tree: Hierarchy,
    by_name: Mapping[str, ParameterValue],
    path: ElementPath,
    mapping: Sequence[MappingEntry],
) -> None:
    """Remark values that a mapping leaves out although the element has a variable of their name."""
    named = {entry.source for entry in mapping}
    # Names as they stand below the element: of a component its variables, of a system those of its components.
    variables = {
        ".".join((*place[len(path) :], variable))
        for place, (_, fmu) in tree.components.items()
        if fmu is not None and place[: len(path)] == path
        for variable in fmu.variables
    }
    for name, value in by_name.items():
        if name in named:
            continue
        # Another binding may use it, so the whole system decides.
        if name not in variables:
            tree.left_out[value.place] = name
            continue
        element = ".".join(path) or "The system"
        message = f"{element} has a parameter '{name}', but the mapping does not name it; the value is not used."
        tree.findings.remark(value.place, message, "Map it, or take it out of the parameter set.")
