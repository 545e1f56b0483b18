"""FMUs by their modelDescription.xml; no binary is ever loaded here.

Reference: FMI 1.0 for co-simulation and for model exchange, FMI 2.0.4 and FMI 3.0.1, section 2 of each.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from shipcosim.errors import ShipcosimError
from shipcosim.ssp.fmu.fmi1 import interfaces_of, is_negated, items_of, traits_of
from shipcosim.ssp.xml.archive import entries, read_entry
from shipcosim.ssp.xml.definitions import read_units
from shipcosim.ssp.xml.document import LARGEST_FILE, Document, Findings, is_true, local, parse
from shipcosim.ssp.xml.validation import validate
from shipcosim.ssp.xml.values import KINDS, read_value


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU.

    Parameters
    ----------
    name : str
        Unique within the FMU.
    value_reference : int
        Handle for getting and setting.
    type : str
        As in the model description: ``"Real"``, ``"Float32"``, ``"Enumeration"``, ...
    causality, variability : str
        As in FMI, defaults filled in.
    initial : str or None
        As in FMI where it is given.
    unit : str or None
        Name of the unit.
    start : float, int, bool, str, bytes, tuple of them (arrays) or None
        Start value.
    minimum, maximum : float, int or None
        Bounds.
    description : str
        One line.
    items : mapping of str to int
        Items of an enumeration.
    dimensions : tuple of int
        Size of an array, by the start values of the structural parameters that set it; empty for a scalar.
    sizes : tuple of (int or str)
        The same as written: a number, or the name of the structural parameter.
    negated : bool
        FMI 1.0: it is the negative of the variable with the same value reference.
    whole, place : Variable or None, int
        Of an array's element: the array, and which of its values this one is.
    """

    name: str
    value_reference: int
    type: str
    causality: str = "local"
    variability: str = "continuous"
    initial: str | None = None
    unit: str | None = None
    start: object = None
    minimum: float | None = None
    maximum: float | None = None
    description: str = ""
    items: Mapping = field(default_factory=dict)
    dimensions: tuple[int, ...] = ()
    sizes: tuple = ()
    negated: bool = False
    whole: object = None
    place: int = 0

    @property
    def kind(self):
        """Kind of the type: Real, Integer, Boolean, String, Enumeration, Binary or Clock."""
        return KINDS[self.type]

    @property
    def settable(self):
        """Whether a start value may be set from outside before initialisation."""
        given = self.causality in ("input", "parameter", "structuralParameter") or self.initial in ("exact", "approx")
        return given and self.variability != "constant"


@dataclass(frozen=True)
class FmuDescription:
    """What an FMU says about itself.

    Parameters
    ----------
    path : Path
        Its archive on disk.
    fmi_version : str
        ``"1.0"``, ``"2.0"`` or ``"3.0"``.
    model_name, token, description, generation_tool : str
        `token` is the GUID or, in FMI 3.0, the instantiation token.
    interfaces : mapping of str to mapping
        By ``"CoSimulation"`` and ``"ModelExchange"``: the attributes given there, as texts.
    variables : mapping of str to Variable
        By name, in the file's order; aliases of FMI 3.0 included.
    units : mapping of str to Unit
        Those with a definition.
    platforms : tuple of str
        Folders with binaries, e.g. ``"linux64"`` or ``"x86_64-linux"``.
    experiment : mapping of str to float
        ``startTime``, ``stopTime``, ``stepSize``, ``tolerance``, where given.
    n_states, n_event_indicators : int
        For model exchange in FMI 1.0 and 2.0; an FMU of FMI 3.0 is asked for them while it runs.
    arrays : mapping of str to tuple of int
        Dimensions of the arrays whose elements stand in `variables` in their place.
    """

    path: Path
    fmi_version: str
    model_name: str
    token: str
    variables: Mapping
    description: str = ""
    generation_tool: str = ""
    interfaces: Mapping = field(default_factory=dict)
    units: Mapping = field(default_factory=dict)
    platforms: tuple[str, ...] = ()
    experiment: Mapping = field(default_factory=dict)
    n_states: int = 0
    n_event_indicators: int = 0
    arrays: Mapping = field(default_factory=dict)

    def capability(self, name, interface="CoSimulation"):
        """Truth of a capability flag, e.g. ``"canGetAndSetFMUstate"``; false where it is not given."""
        return is_true(self.interfaces.get(interface, {}).get(name))

    @property
    def model_identifier(self):
        """Name of the co-simulation binary without its ending; empty where there is none."""
        return self.identifier("CoSimulation")

    def identifier(self, interface):
        """Name of the binary of one form, without its ending; empty where it does not offer this form."""
        return self.interfaces.get(interface, {}).get("modelIdentifier", "")

    def named(self, *causalities):
        """Names of the variables of these causalities."""
        return [variable.name for variable in self.variables.values() if variable.causality in causalities]


def read_fmu(path, shown=None):
    """Read the description of an FMU without running any of it.

    Parameters
    ----------
    path : path
        The .fmu.
    shown : str, optional
        Its name in messages, where it is not `path`.

    Returns
    -------
    FmuDescription

    Raises
    ------
    ShipcosimError
        With everything that is wrong with it.
    """
    findings = Findings()
    fmu = describe_fmu(path, findings, shown)
    if findings.errors:
        raise ShipcosimError(findings.errors)
    return fmu


def describe_fmu(path, findings, shown=None):
    """Like `read_fmu`, but collecting what is wrong in `findings`; None where nothing can be read."""
    shown = shown or str(path)
    try:
        data = read_entry(path, "modelDescription.xml", LARGEST_FILE, shown)
        names = entries(path, shown)
    except ShipcosimError as error:
        findings.problems += error.problems
        return None
    if data is None:
        findings.error(shown, "The archive has no modelDescription.xml.", "It is no FMU; export it again.")
        return None
    file = f"{shown}/modelDescription.xml"
    root = parse(data, file, findings, utf8=False)
    if root is None or not _is_fmi(root, file, findings):
        return None
    version = root.get("fmiVersion")[:1]
    before = len(findings.problems)
    validate(root, f"fmi{version}", file, findings)
    if len(findings.problems) > before:
        return None  # a description that breaks its schema is not worth guessing at
    return _description(Document(file, root), Path(path), names, findings)


def _is_fmi(root, file, findings):
    version = root.get("fmiVersion", "")
    if local(root) != "fmiModelDescription":
        findings.error(file, f"Its outermost element is <{local(root)}>.", "Right would be <fmiModelDescription>.")
        return False
    if not version.startswith(("1.", "2.", "3.")):
        found = f"FMI version '{version}'."
        findings.error(file, found, "Versions 1.0, 2.0 and 3.0 are read: export the FMU in one of them.")
        return False
    return True


def _description(document, path, names, findings):
    root = document.root
    version = f"{root.get('fmiVersion')[:1]}.0"
    platforms = {parts[1] for name in names if len(parts := name.split("/")) > 2 and parts[0] == "binaries"}
    return FmuDescription(
        path=path,
        fmi_version=version,
        model_name=root.get("modelName", ""),
        token=root.get("guid") or root.get("instantiationToken", ""),
        variables=_read_variables(document, findings),
        description=root.get("description", ""),
        generation_tool=root.get("generationTool", ""),
        interfaces=interfaces_of(root) if version == "1.0" else _interfaces(root),
        units=read_units(_parts(root, "UnitDefinitions")),
        platforms=tuple(sorted(platforms)),
        experiment=_experiment(root),
        n_states=_n_states(root),
        n_event_indicators=int(root.get("numberOfEventIndicators") or 0),
    )


def _interfaces(root):
    known = ("CoSimulation", "ModelExchange", "ScheduledExecution")
    return {local(part): dict(part.attrib) for part in root if local(part) in known}


def _n_states(root):
    """Number of continuous states: given in FMI 1.0, that of the listed derivatives in FMI 2.0."""
    derivatives = [part for group in _parts(root, "ModelStructure") if local(group) == "Derivatives" for part in group]
    return int(root.get("numberOfContinuousStates") or 0) or len([part for part in derivatives if local(part)])


def _parts(root, name):
    return [part for group in root if local(group) == name for part in group if local(part)]


def _experiment(root):
    given = next((dict(part.attrib) for part in root if local(part) == "DefaultExperiment"), {})
    return {name: float(text) for name, text in given.items()}


def _read_variables(document, findings):
    """Variables by name; FMI 1.0 and 2.0 put the type into a child element, FMI 3.0 makes it the element itself."""
    types = {part.get("name"): part for part in _parts(document.root, "TypeDefinitions")}
    elements = [part for part in _parts(document.root, "ModelVariables") if _type_element(part) is not None]
    sizes = {part.get("valueReference"): (part.get("name"), part.get("start")) for part in elements}
    is_first = document.root.get("fmiVersion", "").startswith("1.")
    variables = {}
    for element in elements:
        for name, description in _names(element):
            if name in variables:
                findings.error(document.place(element, name), "A second variable has this name.", "Names must differ.")
            try:
                variables[name] = _variable(element, name, description, types, sizes, is_first)
            except ValueError as error:
                findings.error(document.place(element, name), str(error))
    return variables


def _names(element):
    yield element.get("name"), element.get("description", "")
    for alias in (part for part in element if local(part) == "Alias"):
        yield alias.get("name"), alias.get("description", "")


def _type_element(element):
    """The element that carries type, unit, start and bounds."""
    if local(element) != "ScalarVariable":
        return element if local(element) in KINDS else None
    return next((part for part in element if local(part) in KINDS), None)


def _variable(element, name, description, types, sizes, is_first):
    typed = _type_element(element)
    declared = types.get(typed.get("declaredType"))
    kind = KINDS[local(typed)]
    written = [part for part in element if local(part) == "Dimension"]
    dimensions = tuple(_size(part, sizes) for part in written)
    traits = traits_of(element, typed, kind) if is_first else _traits(element, kind)
    return Variable(
        name=name,
        value_reference=int(element.get("valueReference")),
        type=local(typed),
        **traits,
        unit=_attribute(typed, declared, "unit"),
        start=_start(typed, kind, dimensions),
        minimum=_bound(typed, declared, kind, "min"),
        maximum=_bound(typed, declared, kind, "max"),
        description=description,
        items=_items(declared, is_first) if kind == "Enumeration" else {},
        dimensions=dimensions,
        sizes=tuple(_size_as_written(part, sizes) for part in written),
        negated=is_first and is_negated(element),
    )


def _traits(element, kind):
    return {
        "causality": element.get("causality", "local"),
        "variability": element.get("variability", "continuous" if kind == "Real" else "discrete"),
        "initial": element.get("initial"),
    }


def _size(dimension, sizes):
    """Size of one dimension of an array: given as such, or the start value of a structural parameter."""
    text = dimension.get("start") or sizes.get(dimension.get("valueReference"), (None, None))[1]
    if text is None:
        raise ValueError("The size of a dimension is neither given nor that of a variable with a start value.")
    return read_value("Integer", text)


def _size_as_written(dimension, sizes):
    text = dimension.get("start")
    return sizes[dimension.get("valueReference")][0] if text is None else read_value("Integer", text)


def _declaration(declared):
    """The element of a declared type that carries the attributes, which FMI 1.0 and 2.0 nest in another one."""
    if declared is None or local(declared) not in ("SimpleType", "Type"):
        return declared
    return next((part for part in declared if local(part).removesuffix("Type") in KINDS), None)


def _attribute(typed, declared, name):
    declaration = _declaration(declared)
    return typed.get(name) or (declaration.get(name) if declaration is not None else None)


def _bound(typed, declared, kind, name):
    text = _attribute(typed, declared, name)
    return None if text is None or kind not in ("Real", "Integer", "Enumeration") else float(text)


def _items(declared, is_first):
    declaration = _declaration(declared)
    if is_first:
        return items_of(declaration)
    found = [] if declaration is None else [part for part in declaration if local(part) == "Item"]
    return {item.get("name"): int(item.get("value")) for item in found}


def _start(typed, kind, dimensions):
    kind = "Integer" if kind == "Enumeration" else kind
    nested = [part.get("value") for part in typed if local(part) == "Start"]
    if nested:
        values = tuple(read_value(kind, text) for text in nested)
        return values if dimensions else values[0]
    if typed.get("start") is None:
        return None
    if dimensions:
        return tuple(read_value(kind, text) for text in typed.get("start").split())
    return read_value(kind, typed.get("start"))
