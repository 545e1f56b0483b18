"""Files, nested systems, times and FMUs that other tools read differently.

Each function takes a Subject and yields (place, description); an empty text: the feature's words.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from urllib.parse import unquote

import lxml.etree as etree

from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.portability.subject import Found, Subject, elements_of, is_fmi_1
from shipcosim.ssp.read.structure import FMU, DictionaryReference, SystemElement
from shipcosim.ssp.xml.annotations import STEP_SIZES
from shipcosim.ssp.xml.document import NAMESPACES, child, children, local
from shipcosim.ssp.xml.markup import OSP_TYPE

DECLARING = re.compile(rb"<[\w.-]+:Algorithm\s[^>]*xmlns")
"""A start tag that declares a prefix; whether it does cannot be seen any more once it is read."""


def prefixes(subject: Subject) -> Found:
    """Other namespace prefixes than the standard's own."""
    # The prefixes of the standard, by namespace.
    wanted = {uri: prefix for prefix, uri in NAMESPACES.items()}
    for document in subject.documents:
        for part in document.root.iter(etree.Element):
            uri = etree.QName(part).namespace
            if uri in wanted and part.prefix != wanted[uri]:
                name = local(part)
                shown = f"{part.prefix}:{name}" if part.prefix else name
                yield document.place(part), f"<{shown}> instead of <{wanted[uri]}:{name}>"
                break


def version_2(subject: Subject) -> Found:
    """SSP 2.0."""
    if subject.structure is not None and subject.structure.version.startswith("2"):
        yield subject.place, ""


def escaped_addresses(subject: Subject) -> Found:
    """An address with escaped characters."""
    for part in subject.components:
        if part.source and unquote(part.source) != part.source:
            yield part.place, f"the address '{part.source}' has escaped characters"


def nested_systems(subject: Subject) -> Found:
    """A system in a system."""
    yield from ((part.place, "") for part in subject.elements if isinstance(part, SystemElement))


def other_files(subject: Subject) -> Found:
    """A component that is a system of its own."""
    yield from ((part.place, "") for part in subject.components if part.type != FMU)


def dictionaries(subject: Subject) -> Found:
    """A signal dictionary."""
    yield from (
        (part.place, "") for part in subject.elements if isinstance(part, DictionaryReference)
    )


def system_connections(subject: Subject) -> Found:
    """A connection with a connector of the outermost system."""
    for link in () if subject.structure is None else subject.structure.system.links:
        if not (link.start_element and link.end_element):
            yield link.place, ""


def _osp_steps(subject: Subject) -> Iterator[etree._Element]:
    """FixedStepAlgorithm elements that libcosim looks for, whatever their prefixes."""
    # libcosim looks only into the default experiment, and only at its own type of annotation.
    experiment = child(subject.document.root, "ssd:DefaultExperiment")
    for annotation in (
        () if experiment is None else children(experiment, "ssd:Annotations", "ssc:Annotation")
    ):
        if annotation.get("type") == OSP_TYPE:
            yield from (
                part
                for part in annotation.iter(etree.Element)
                if local(part) == "FixedStepAlgorithm"
            )


def steps_of_others(subject: Subject) -> Found:
    """A step size that only another tool's annotation states."""
    if subject.is_ssp and not list(_osp_steps(subject)) and subject.system.experiment.step_size:
        yield next(_stated(subject)), ""


def no_steps(subject: Subject) -> Found:
    """No step size."""
    if subject.is_ssp and not list(_osp_steps(subject)) and not subject.system.experiment.step_size:
        yield subject.place, ""


def steps(subject: Subject) -> Found:
    """A step size."""
    if subject.is_ssp and subject.system.experiment.step_size:
        yield next(_stated(subject)), f"the step size {subject.system.experiment.step_size:g} s"


def _stated(subject: Subject) -> Iterator[str]:
    """Places that state a base step, and finally the file itself."""
    for part in elements_of(subject, *STEP_SIZES):
        if part.get(STEP_SIZES[local(part)]) is not None:
            yield subject.document.place(part)
    yield subject.place


def osp_annotations(subject: Subject) -> Found:
    """OSP's algorithm with another prefix than osp:, or with the prefix declared on itself."""
    if subject.package is None:
        return
    for step in _osp_steps(subject):
        # The prefix must be declared further up, and be exactly osp:.
        algorithm = step.getparent()
        declares = DECLARING.search((subject.package.folder / subject.package.ssd).read_bytes())
        if declares or algorithm.attrib or algorithm.prefix != "osp" or step.prefix != "osp":
            yield subject.document.place(algorithm), ""


def hints_of_others(subject: Subject) -> Found:
    """A component's step size in another tool's annotation."""
    for part in elements_of(subject, "StepSizeHint"):
        annotation = part.getparent()
        osp = (
            part.prefix == "osp"
            and local(annotation) == "Annotation"
            and annotation.get("type") == OSP_TYPE
        )
        if not osp:
            yield subject.document.place(part), ""


def start_times(subject: Subject) -> Found:
    """A start time other than 0."""
    if subject.is_ssp and subject.system.experiment.start_time:
        (experiment,) = children(subject.document.root, "ssd:DefaultExperiment")
        place = subject.document.place(experiment)
        yield place, f"the start time {subject.system.experiment.start_time:g} s"


def fmi_3(subject: Subject) -> Found:
    """An FMU of FMI 3.0."""
    yield from ((name, "") for name, fmu in subject.fmus if fmu.fmi_version.startswith("3"))


def without_co_simulation(subject: Subject) -> Found:
    """An FMU that offers no co-simulation."""
    yield from (
        (n, "")
        for n, fmu in subject.fmus
        if "CoSimulation" not in fmu.interfaces and not is_fmi_1(fmu)
    )


def without_co_simulation_1(subject: Subject) -> Found:
    """An FMU of FMI 1.0 that offers no co-simulation."""
    yield from (
        (n, "") for n, fmu in subject.fmus if "CoSimulation" not in fmu.interfaces and is_fmi_1(fmu)
    )


def model_exchange_asked(subject: Subject) -> Found:
    """Model exchange asked for, where the FMU also offers co-simulation."""
    for name, component in subject.system.components.items():
        if (
            component.implementation == "ModelExchange"
            and "CoSimulation" in component.fmu.interfaces
        ):
            yield name, ""


def same_guids(subject: Subject) -> Found:
    """Components whose FMU shares its GUID with another FMU that has other variables."""
    first = defaultdict(list)
    # libcosim identifies FMUs by GUID: equal GUIDs with other variables are mixed up.
    for name, fmu in subject.fmus:
        others = [other for other in first[fmu.token] if other.path != fmu.path]
        if any(_variables(other) != _variables(fmu) for other in others):
            yield name, f"{fmu.path.name} has the GUID of {others[0].path.name}"
        first[fmu.token].append(fmu)


def _variables(fmu: FmuDescription) -> list[tuple]:
    return [(v.name, v.value_reference, v.type, v.causality) for v in fmu.variables.values()]
