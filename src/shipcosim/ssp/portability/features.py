"""Where a system has a feature that other tools take otherwise; see `shipcosim.ssp.portability.support_table`.

Each function takes a Subject and yields (place, what is there); an empty text stands for the feature's own words.
"""

import re
from collections import defaultdict
from math import isclose
from urllib.parse import unquote

import lxml.etree as etree

from shipcosim.ssp.flatten.ports import Key
from shipcosim.ssp.osp.groups import file_names
from shipcosim.ssp.portability.subject import elements_of
from shipcosim.ssp.read.structure import FMU, DictionaryReference, SystemElement
from shipcosim.ssp.xml.annotations import STEP_SIZES
from shipcosim.ssp.xml.document import NAMESPACES, child, children, local
from shipcosim.ssp.xml.markup import OSP_TYPE
from shipcosim.ssp.xml.values import KINDS, SSP_1_TYPES
from shipcosim.units import find_unit, relation

DECLARING = re.compile(rb"<[\w.-]+:Algorithm\s[^>]*xmlns")
"""A start tag that declares a prefix; whether it does cannot be seen any more once it is read."""


# packaging


def prefixes(subject):
    wanted = {uri: prefix for prefix, uri in NAMESPACES.items()}
    for document in subject.documents:
        for part in document.root.iter(etree.Element):
            uri = etree.QName(part).namespace
            if uri in wanted and part.prefix != wanted[uri]:
                yield document.place(part), f"<{_shown(part)}> instead of <{wanted[uri]}:{local(part)}>"
                break


def _shown(part):
    return f"{part.prefix}:{local(part)}" if part.prefix else local(part)


def version_2(subject):
    if subject.structure is not None and subject.structure.version.startswith("2"):
        yield subject.document.place(subject.document.root), ""


def escaped_addresses(subject):
    for part in subject.components:
        if part.source and unquote(part.source) != part.source:
            yield part.place, f"the address '{part.source}' has escaped characters"


# systems in systems


def nested_systems(subject):
    yield from ((part.place, "") for part in subject.elements if isinstance(part, SystemElement))


def other_files(subject):
    yield from ((part.place, "") for part in subject.components if part.type != FMU)


def dictionaries(subject):
    yield from ((part.place, "") for part in subject.elements if isinstance(part, DictionaryReference))


def system_connections(subject):
    for link in () if subject.structure is None else subject.structure.system.links:
        if not (link.start_element and link.end_element):
            yield link.place, ""


# connections


def reversed_links(subject):
    if subject.tree is not None:
        wires = {(wire.source, wire.target) for wire in subject.tree.wires}
        for link, _, _ in subject.links:
            ends = Key((link.end_element,), link.end_connector), Key((link.start_element,), link.start_connector)
            if ends in wires:
                yield link.place, ""


def undeclared_connectors(subject):
    declared = {(part.name, connector.name) for part in subject.elements for connector in _connectors(part)}
    for link, _, _ in subject.links:
        for end in ((link.start_element, link.start_connector), (link.end_element, link.end_connector)):
            if end not in declared:
                yield link.place, f"{'.'.join(end)} is not declared as a connector"


def _connectors(part):
    return getattr(part, "connectors", ())


def typeless_connectors(subject):
    for part in subject.components:
        yield from ((connector.place, "") for connector in part.connectors if connector.type is None)


def connectors_of_2(subject):
    for part in elements_of(subject, "Connector"):
        yield from ((subject.document.place(part), f"a connector of type {name}") for name in _types_of_2(part))


def _types_of_2(element):
    return [local(part) for part in element if local(part) in KINDS and local(part) not in SSP_1_TYPES]


def enumeration_connectors(subject):
    for part in subject.components:
        yield from ((connector.place, "") for connector in part.connectors if connector.type == "Enumeration")


def different_types(subject):
    for link, start, end in subject.links:
        kinds = [port.variable.kind for port in (start, end) if port is not None and port.variable is not None]
        if len(kinds) == 2 and kinds[0] != kinds[1]:
            yield link.place, f"a connection between {kinds[0]} and {kinds[1]}"


def enumeration_connections(subject):
    for link, *ports in subject.links:
        if any(p is not None and p.variable is not None and p.variable.kind == "Enumeration" for p in ports):
            yield link.place, ""


def parameter_connections(subject):
    initial = {(c.source, c.target): c for c in subject.system.connections if c.initial}
    for link, _, _ in subject.links:
        ends = (link.start_element, link.start_connector), (link.end_element, link.end_connector)
        if ends in initial or ends[::-1] in initial:
            yield link.place, ""


def mappings(subject):
    for link, _, _ in subject.links:
        if link.transformation is not None and link.transformation.kind != "Linear":
            yield link.place, f"a mapping of {link.transformation.kind} values"


def linear_without_factor(subject):
    for part in elements_of(subject, "LinearTransformation"):
        if part.get("factor") is None and local(part.getparent()) == "Connection":
            yield subject.document.place(part), ""


def unit_conversions(subject):
    """Connections whose whole transformation is another than the one that is written."""
    flat = {(c.source, c.target): c for c in subject.system.connections}
    for link, _, _ in subject.links:
        ends = (link.start_element, link.start_connector), (link.end_element, link.end_connector)
        whole = flat.get(ends) or flat.get(ends[::-1])
        how = link.transformation
        if whole is None or (how is not None and how.kind != "Linear"):
            continue
        written = (how.factor, how.offset) if how is not None else (1.0, 0.0)
        pairs = zip(written, (whole.factor, whole.offset), strict=True)
        if not all(isclose(one, other, rel_tol=1e-12) for one, other in pairs):
            yield link.place, f"a conversion of units, {whole.factor:.6g} times the value plus {whole.offset:.6g}"


# parameters


def sets_on_systems(subject):
    for binding in () if subject.structure is None else subject.structure.system.bindings:
        yield binding.values.place or subject.structure.system.place, ""


def several_sets(subject):
    for part in subject.components:
        yield from ((binding.values.place, "") for binding in part.bindings[1:])


def set_names(subject):
    names = dict.fromkeys(values.name for *_, values in subject.sets)
    if names:
        yield subject.structure.system.place, f"parameter sets {', '.join(map(repr, names))}"


def sets_of_other_names(subject):
    sets = list(subject.sets)
    for part, _, _, values in sets:
        if values.name != sets[0][-1].name:
            yield part.place, f"the parameter set '{values.name}' beside '{sets[0][-1].name}'"


def set_prefixes(subject):
    for part in subject.components:
        yield from ((binding.values.place, "") for binding in part.bindings if binding.prefix)


def set_mappings(subject):
    for part in subject.components:
        yield from ((binding.mapping.place, "") for binding in part.bindings if binding.mapping is not None)


def sets_in_fmus(subject):
    for part in subject.components:
        yield from ((binding.values.place, "") for binding in part.bindings if binding.values.in_component)


def set_units(subject):
    for value, variable, fmu in subject.values:
        own = find_unit(variable.unit, fmu.units)
        if value.unit is not None and own is not None and relation(value.unit, own) == "convertible":
            yield value.place, f"a value in {value.unit.name}, where the FMU has {own.name}"


def set_enumerations(subject):
    for *_, values in subject.sets:
        yield from ((value.place, "") for value in values.values if value.kind == "Enumeration")


def values_of_2(subject):
    for document in subject.documents:
        for part in document.root.iter(etree.Element):
            if local(part) == "Parameter":
                what = f"a value of type {_types_of_2(part)[0]}" if _types_of_2(part) else None
                yield from [(document.place(part, part.get("name")), what)] if what else ()


def values_for_fmi_1(subject):
    for value, variable, fmu in subject.values:
        if _is_first(fmu) and variable.causality == "parameter":
            yield value.place, ""


def integers_for_reals(subject):
    for value, variable, _ in subject.values:
        if (value.kind, variable.kind) == ("Integer", "Real"):
            yield value.place, ""


def values_of_others(subject):
    for value, variable, _ in subject.values:
        if variable.causality not in ("parameter", "input"):
            yield value.place, f"a value for a variable of causality {variable.causality}"


# times


def _osp_steps(subject):
    """FixedStepAlgorithm elements that libcosim looks for, whatever their prefixes."""
    experiment = child(subject.document.root, "ssd:DefaultExperiment")
    for annotation in () if experiment is None else children(experiment, "ssd:Annotations", "ssc:Annotation"):
        if annotation.get("type") == OSP_TYPE:
            yield from (part for part in annotation.iter(etree.Element) if local(part) == "FixedStepAlgorithm")


def steps_of_others(subject):
    if subject.document is not None and not list(_osp_steps(subject)) and subject.system.experiment.step_size:
        yield next(_stated(subject)), ""


def no_steps(subject):
    if subject.document is not None and not list(_osp_steps(subject)) and not subject.system.experiment.step_size:
        yield subject.document.place(subject.document.root), ""


def steps(subject):
    if subject.document is not None and subject.system.experiment.step_size:
        yield next(_stated(subject)), f"the step size {subject.system.experiment.step_size:g} s"


def _stated(subject):
    """Places where a base step is stated, and at last the file's own."""
    for part in elements_of(subject, *STEP_SIZES):
        if part.get(STEP_SIZES[local(part)]) is not None:
            yield subject.document.place(part)
    yield subject.document.place(subject.document.root)


def osp_annotations(subject):
    for step in _osp_steps(subject) if subject.document is not None else ():
        algorithm = step.getparent()
        declares = DECLARING.search((subject.package.folder / subject.package.ssd).read_bytes())
        if declares or algorithm.attrib or algorithm.prefix != "osp" or step.prefix != "osp":
            yield subject.document.place(algorithm), ""


def hints_of_others(subject):
    for part in elements_of(subject, "StepSizeHint"):
        annotation = part.getparent()
        osp = part.prefix == "osp" and local(annotation) == "Annotation" and annotation.get("type") == OSP_TYPE
        if not osp:
            yield subject.document.place(part), ""


def start_times(subject):
    if subject.document is not None and subject.system.experiment.start_time:
        place = subject.document.place(child(subject.document.root, "ssd:DefaultExperiment"))
        yield place, f"the start time {subject.system.experiment.start_time:g} s"


# FMUs


def fmi_3(subject):
    yield from ((name, "") for name, fmu in subject.fmus if fmu.fmi_version.startswith("3"))


def without_co_simulation(subject):
    yield from ((n, "") for n, fmu in subject.fmus if "CoSimulation" not in fmu.interfaces and not _is_first(fmu))


def without_co_simulation_1(subject):
    yield from ((n, "") for n, fmu in subject.fmus if "CoSimulation" not in fmu.interfaces and _is_first(fmu))


def _is_first(fmu):
    return fmu.fmi_version.startswith("1")


def model_exchange_asked(subject):
    for name, component in subject.system.components.items():
        if component.implementation == "ModelExchange" and "CoSimulation" in component.fmu.interfaces:
            yield name, ""


def same_guids(subject):
    """Components whose FMU has the GUID of another one with other variables."""
    first = defaultdict(list)
    for name, fmu in subject.fmus:
        others = [other for other in first[fmu.token] if other.path != fmu.path]
        if any(_variables(other) != _variables(fmu) for other in others):
            yield name, f"{fmu.path.name} has the GUID of {others[0].path.name}"
        first[fmu.token].append(fmu)


def _variables(fmu):
    return [(v.name, v.value_reference, v.type, v.causality) for v in fmu.variables.values()]


# OspSystemStructure.xml


def _osp(subject, *tags):
    return [] if subject.osp is None else [part for part in subject.osp.root.iter(etree.Element) if local(part) in tags]


def osp_without_algorithm(subject):
    if subject.osp is not None and not _osp(subject, "Algorithm"):
        yield subject.osp.place(subject.osp.root), ""


def osp_second_targets(subject):
    seen = set()
    for part in _osp(subject, "Signal", "SignalGroup"):
        end = part.get("function"), part.get("name")
        if end in seen and end[1].startswith("out"):
            yield subject.osp.place(part), f"a second connection from {end[0]}:{end[1]}"
        seen.add(end)


def osp_group_files(subject):
    for name in dict.fromkeys(part.get("simulator") for part in _osp(subject, "VariableGroup")):
        fmu = subject.system.components[name].fmu
        places = [folder / file_names(fmu)[0] for folder in (fmu.path.parent, subject.osp.folder)]
        if not any(place.is_file() for place in places):
            yield name, f"variable groups that are not in {places[0].name}"
