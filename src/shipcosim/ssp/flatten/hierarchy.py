"""From the SSD's nested elements to flat lists: components with their FMUs, ports, wires between ports, and values set.

A port is a connector at its place in the hierarchy. Nested systems, systems in other files and signal dictionaries all
become ports with wires between them, so that what follows knows no hierarchy.
"""

from dataclasses import dataclass, replace

from shipcosim.errors import Problem, ShipcosimError, it_has, suggestion
from shipcosim.ssp.flatten.connections import wire_of
from shipcosim.ssp.flatten.connectors import Key, Port, Setting, Wire, variable_port
from shipcosim.ssp.fmu.arrays import element_connectors, element_links, element_values, without_arrays
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.read.library import Library
from shipcosim.ssp.read.structure import (
    FMU,
    KIND_NAMES,
    SSD,
    SSP,
    ComponentElement,
    DictionaryReference,
    SystemElement,
)
from shipcosim.units import find_unit, relation

MOST_SYSTEMS = 10_000  # a few files that include each other can describe more than any memory holds


class Tree:
    """Everything found on the way through the nested elements.

    Parameters
    ----------
    findings : Findings
        Takes what is wrong.
    described : dict, optional
        Keeps descriptions of FMUs without fault for other trees.
    sizes : mapping of str to mapping of str to int, optional
        Values of structural parameters that give the sizes of arrays, by component, where they are not the FMU's own.
    """

    def __init__(self, findings, described=None, sizes=None):
        self.findings = findings
        self.components: dict[tuple[str, ...], tuple[ComponentElement, FmuDescription | None]] = {}
        self.systems: dict[tuple[str, ...], SystemElement] = {}
        self.ports: dict[Key, Port] = {}
        self.wires: list[Wire] = []
        self.settings: list[Setting] = []
        self.arrays: dict[tuple[str, ...], dict] = {}
        self.references: dict[Key, Key] = {}
        self.library = Library(findings, described)
        self.sizes = sizes or {}

    def grow(self, structure, package):
        """Take in the outermost system."""
        self.library.packages.append(package)
        self._system(structure.system, (), _Place(structure, package, (), (structure.system.place,)), ())
        self._join_dictionaries()

    def _system(self, element, path, place, more_bindings):
        self.systems[path] = element
        if len(self.systems) > MOST_SYSTEMS:
            too_many = Problem(element.place, f"There are more than {MOST_SYSTEMS} systems.", "Take some away.")
            raise ShipcosimError([*dict.fromkeys(self.findings.errors), too_many])
        place = replace(place, dictionaries=(self._dictionaries(element, path, place), *place.dictionaries))
        connectors, self.arrays[path] = element_connectors(element.connectors, {}, self.findings)
        for connector in connectors:
            fields = (connector.kind, connector.type, "system", connector.unit, connector.items)
            self.ports[Key(path, connector.name)] = Port(
                *fields, description=connector.description, place=connector.place
            )
        for part in element.elements:
            inner = (*path, part.name)
            if isinstance(part, SystemElement):
                self._system(part, inner, place, ())
            elif isinstance(part, DictionaryReference):
                self._reference(part, inner, place)
            else:
                self._component(part, inner, place)
        for link in element.links:
            self._link(link, element, path)
        self._bindings(element.bindings, path, place)
        for bindings, outer in more_bindings:
            self._bindings(bindings, path, outer)

    def _link(self, link, element, path):
        """Wires of a connection, one for each element where it joins arrays."""
        ends = ((link.start_element, link.start_connector), (link.end_element, link.end_connector))
        owners = [self.arrays.get(path if owner is None else (*path, owner), {}) for owner, _ in ends]
        dimensions = (known.get(name, ()) for known, (_, name) in zip(owners, ends, strict=True))
        for single in element_links(link, *dimensions, self.findings):
            wire = wire_of(single, element, path, self)
            self.wires += [] if wire is None else [wire]

    def _component(self, element, path, place):
        if element.type in (SSD, SSP):
            self._other_file(element, path, place)
        elif element.type == FMU:
            self._fmu(element, path, place)
        else:
            remedy = f"Known are {FMU}, {SSD}, {SSP}."
            self.findings.error(element.place, f"Components of type '{element.type}' are not known.", remedy)
            self.components[path] = element, None

    def _other_file(self, element, path, place):
        """A component that is a system in another file or elsewhere in this one counts as if it stood here."""
        found = self._structure(element, place)
        if found is not None and found[1].place in place.around:
            self.findings.error(element.place, f"'{element.source}' contains itself.", "Break the circle.")
            found = None
        if found is None:
            self.components[path] = element, None
            return
        structure, system, package = found
        inner = _Place(structure, package, place.dictionaries, (*place.around, system.place))
        self._system(system, path, inner, ((element.bindings, place),))

    def _structure(self, element, place):
        uri, _, fragment = (element.source or "").partition("#")
        if not uri:
            system = _with_id(place.structure.system, fragment)
            if system is None:
                self.findings.error(element.place, f"No system in this file has the id '{fragment}'.", "Give it one.")
            return system and (place.structure, system, place.package)
        file = self.library.file(element, uri, place)
        if file is None:
            return None
        package, name = place.package, file
        if element.type == SSP:
            shown = place.package.show(file)
            address = f"{file}#{fragment}" if fragment else file
            package = self.library.package(address, place.package.fmus, shown)
            if package is None:
                return None
            name = package.folder / package.ssd
        structure = self.library.structure(package, name)
        return structure and (structure, structure.system, package)

    def _fmu(self, element, path, place):
        if element.source is None:
            self.findings.error(element.place, "It has no source: there is nothing to run.", "Name an FMU or a system.")
        file = None if element.source is None else self.library.file(element, element.source, place)
        fmu = self.library.fmu(file, place.package) if file else None
        fmu = fmu and without_arrays(fmu, element.place, self.findings, self.sizes.get(".".join(path)))
        self.components[path] = element, fmu
        self.arrays[path] = {} if fmu is None else dict(fmu.arrays)
        connectors, declared = element_connectors(element.connectors, self.arrays[path], self.findings)
        self.arrays[path] |= declared
        for connector in connectors:
            self.ports[Key(path, connector.name)] = self._component_port(connector, element, fmu)
        if fmu is not None:
            self._check_implementation(element, fmu)
        self._bindings(element.bindings, path, place, near=True, fmu=fmu)

    def _check_implementation(self, element, fmu):
        wanted = element.implementation
        forms = ("CoSimulation", "ModelExchange") if wanted == "any" else (wanted,)
        if not any(form in fmu.interfaces for form in forms):
            remedy = f"It offers {', '.join(fmu.interfaces)}."
            self.findings.error(element.place, f"{fmu.path.name} offers no {' and no '.join(forms)}.", remedy)

    def _component_port(self, connector, element, fmu):
        """Port of a component's connector, checked against the FMU."""
        variable = None if fmu is None else fmu.variables.get(connector.name)
        if variable is None:
            if fmu is not None:
                found = f"{fmu.path.name} has no {_causality(connector.kind)} '{connector.name}'."
                known = fmu.named(connector.kind) or list(fmu.variables)
                self.findings.error(connector.place, found, it_has(connector.name, known))
            fields = (connector.kind, connector.type, "component", connector.unit, connector.items)
            return Port(*fields, place=connector.place)
        self._compare(connector, variable, fmu)
        port = variable_port(variable, fmu, connector.place)
        description = connector.description or variable.description
        return replace(
            port, unit=connector.unit or port.unit, items=connector.items or port.items, description=description
        )

    def _compare(self, connector, variable, fmu):
        name = fmu.path.name
        if connector.kind in KIND_NAMES and connector.kind != variable.causality:
            found = (
                f"The connector is of kind {connector.kind}, the variable in {name} of causality {variable.causality}."
            )
            self.findings.error(connector.place, found, f'Write kind="{variable.causality}".')
        if connector.type not in (None, variable.kind):
            found = f"The connector is of type {connector.type}, but in {name} the variable is {variable.type}."
            self.findings.error(connector.place, found, f"Write <{variable.type}>, or leave the type out.")
        own = find_unit(variable.unit, fmu.units)
        if own is None or connector.unit is None:
            return
        related = relation(connector.unit, own)
        found = f"The connector is in {connector.unit.name}, the variable in {name} in {own.name}"
        if related == "incompatible":
            self.findings.error(connector.place, f"{found}; these cannot be converted.", f'Write unit="{own.name}".')
        elif related != "same":
            how = "not converted, a definition is missing" if related == "unknown" else "values are converted"
            self.findings.remark(connector.place, f"{found}: {how}.")

    def _reference(self, element, path, place):
        """Ports of a dictionary reference, each joined later with the dictionary's."""
        lookup = (known[element.dictionary] for known in place.dictionaries if element.dictionary in known)
        owner, entries = next(lookup, (None, None))
        if entries is None:
            known = {name for names in place.dictionaries for name in names}
            found = f"There is no signal dictionary '{element.dictionary}' here or in a system around."
            self.findings.error(element.place, found, suggestion(element.dictionary, known))
        for connector in element.connectors:
            key = Key(path, connector.name)
            fields = (connector.kind, connector.type, "reference", connector.unit, connector.items)
            self.ports[key] = Port(*fields, place=connector.place)
            if entries is None:
                continue
            if connector.name not in entries:
                found = f"The dictionary '{element.dictionary}' has no '{connector.name}'."
                self.findings.error(connector.place, found, it_has(connector.name, entries))
                continue
            entry = entries[connector.name]
            self.references[key] = Key(owner, connector.name)
            self.ports[self.references[key]] = Port("inout", entry.kind, "dictionary", entry.unit, entry.items)

    def _dictionaries(self, element, path, place):
        """Dictionaries defined on a system: where they live among the ports, and their entries, by name."""
        found = {}
        for name, source in element.dictionaries.items():
            document = self.library.content(source, place)
            entries = {} if document is None else self.library.dictionary(document)
            found[name] = (*path, "", name), entries
        return found

    def _join_dictionaries(self):
        """A reference that something flows into feeds the dictionary; from any other one the dictionary is read."""
        fed = {wire.target for wire in self.wires}
        for reference, entry in self.references.items():
            ends = (reference, entry) if reference in fed else (entry, reference)
            self.wires.append(Wire(*ends, place=self.ports[reference].place))

    def _bindings(self, bindings, path, place, near=False, fmu=None):
        for binding in bindings:
            document = self.library.content(binding.values, place, fmu)
            if document is None:
                continue
            values = self.library.parameter_set(document)
            mapping = None
            if binding.mapping is not None:
                content = self.library.content(binding.mapping, place, fmu)
                mapping = () if content is None else self.library.mapping(content)
            self.settings += self._settings(values, path, binding.prefix, mapping, near)

    def bind(self, values, path=()):
        """Set a parameter set's values, over everything set before."""
        self.settings += self._settings(values, path, "", None, False)

    def _settings(self, values, path, prefix, mapping, near):
        named = [(prefix + value.name, value) for value in values.values]
        if mapping is None:
            return [
                Setting(path, prefix + one.name, one, near=near)
                for _, value in named
                for one in element_values(value, self.findings)
            ]
        by_name = dict(named)
        settings = []
        for entry in mapping:
            if entry.source not in by_name:
                found = f"The parameter set '{values.name}' has no '{entry.source}'."
                self.findings.error(entry.place, found, it_has(entry.source, by_name))
                continue
            how = (entry.transformation, entry.suppress_unit_conversion)
            renamed = replace(by_name[entry.source], name=entry.target)
            settings += [
                Setting(path, one.name, one, *how, near=True) for one in element_values(renamed, self.findings)
            ]
        return settings


@dataclass(frozen=True)
class _Place:
    """Where the walk is: in which file, with which dictionaries in sight, within which systems of whole files."""

    structure: object
    package: object
    dictionaries: tuple
    around: tuple

    @property
    def folder(self):
        return self.structure.document.folder


def _with_id(system, wanted):
    if system.id == wanted:
        return system
    inner = (_with_id(part, wanted) for part in system.elements if isinstance(part, SystemElement))
    return next((found for found in inner if found is not None), None)


def _causality(kind):
    return {"calculatedParameter": "calculated parameter", "structuralParameter": "structural parameter"}.get(
        kind, kind
    )
