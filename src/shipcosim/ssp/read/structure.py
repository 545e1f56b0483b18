"""The SSD as written: systems, elements, connectors, connections and bindings, unresolved.

Reference: System Structure and Parameterization 1.0, section 5; type names of 2.0 are understood too.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from shipcosim.ssp.read.parameters import Transformation
from shipcosim.ssp.xml.document import Document
from shipcosim.units import Unit

End = tuple[str | None, str]
"""An end of a connection: its component, or none for a connector of the system, and its connector."""


def label(end: End) -> str:
    """Name of an end as users write it: ``component.connector``; on the system its connector alone."""
    component, connector = end
    return connector if component is None else f"{component}.{connector}"


FMU = "application/x-fmu-sharedlibrary"
SSD = "application/x-ssp-definition"
SSP = "application/x-ssp-package"
"""Types of components: what their sources are."""

KIND_NAMES = (
    "input",
    "output",
    "parameter",
    "calculatedParameter",
    "structuralParameter",
    "constant",
    "local",
    "inout",
    "unspecified",
)
"""Kinds of connectors of SSP 2.0; 1.0 has the first four and inout."""


@dataclass(frozen=True)
class Connector:
    """A connector of a system, component or dictionary reference.

    Parameters
    ----------
    name : str
        Unique within its owner.
    kind : str
        ``"input"``, ``"output"``, ``"parameter"``, ``"calculatedParameter"``, ``"inout"``, ...
    type : str or None
        Real, Integer, Boolean, String, Enumeration, Binary or Clock; None where the SSD leaves it open.
    unit : Unit or None
        Of a Real.
    items : mapping of str to int
        Items of an Enumeration.
    description : str
        One line.
    place : str
        Where it stands, for messages.
    dimensions : tuple of (int or None)
        Sizes of an array; None where the SSD leaves one open.
    """

    name: str
    kind: str
    type: str | None = None
    unit: Unit | None = None
    items: Mapping[str, int] = field(default_factory=dict)
    description: str = ""
    place: str = ""
    dimensions: tuple[int | None, ...] = ()


@dataclass(frozen=True)
class Link:
    """A Connection element between two connectors; their kinds give the direction.

    Parameters
    ----------
    start_element, end_element : str or None
        Names of elements of the system; None: the system itself.
    start_connector, end_connector : str
        Their connectors.
    transformation : Transformation or None
        Of the value on its way.
    suppress_unit_conversion : bool
        Leave the value as it is even if units differ.
    place : str
        Where it stands, for messages.
    start_indices, end_indices : tuple of int
        Name a single element of an array, counted from 1; empty for the whole.
    """

    start_element: str | None
    start_connector: str
    end_element: str | None
    end_connector: str
    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False
    place: str = ""
    start_indices: tuple[int, ...] = ()
    end_indices: tuple[int, ...] = ()

    @property
    def ends(self) -> tuple[End, End]:
        """Element and connector of the start, and of the end."""
        return (self.start_element, self.start_connector), (self.end_element, self.end_connector)


@dataclass(frozen=True)
class Source:
    """A parameter set, mapping or dictionary in an SSD: inline or by address.

    Parameters
    ----------
    uri : str or None
        Address relative to the SSD or, if `in_component`, to the component.
    inline : Document or None
        The content where it stands in the SSD itself.
    in_component : bool
        Whether the file is inside the component's FMU.
    place : str
        Where it stands, for messages.
    """

    uri: str | None
    inline: Document | None
    in_component: bool = False
    place: str = ""


@dataclass(frozen=True)
class Binding:
    """A ParameterBinding: a parameter set, the prefix of its names, and perhaps a parameter mapping."""

    values: Source
    mapping: Source | None = None
    prefix: str = ""


@dataclass(frozen=True)
class ComponentElement:
    """A Component: an FMU or a system in another file; without a source it is a placeholder for one."""

    name: str
    source: str | None
    type: str
    implementation: str
    connectors: tuple[Connector, ...]
    bindings: tuple[Binding, ...]
    step_size: float | None
    place: str


@dataclass(frozen=True)
class DictionaryReference:
    """A SignalDictionaryReference: connectors that are signals of a dictionary of this system or one around it."""

    name: str
    dictionary: str
    connectors: tuple[Connector, ...]
    place: str


@dataclass(frozen=True)
class SystemElement:
    """A System with everything in it.

    Parameters
    ----------
    name : str
        Unique within the system around it.
    connectors : tuple of Connector
        Of the system itself.
    bindings : tuple of Binding
        Parameter sets bound to it.
    elements : tuple of ComponentElement, DictionaryReference or SystemElement
        What it consists of.
    links : tuple of Link
        Connections between them.
    dictionaries : mapping of str to Source
        Signal dictionaries by name.
    annotated_step_size : float or None
        Base step size that an annotation of the system gives. [s]
    place : str
        Where it stands, for messages.
    id : str or None
        By which a component elsewhere can mean it.
    """

    name: str
    connectors: tuple[Connector, ...]
    bindings: tuple[Binding, ...]
    elements: "tuple[ComponentElement | DictionaryReference | SystemElement, ...]"
    links: tuple[Link, ...]
    dictionaries: Mapping[str, Source]
    annotated_step_size: float | None
    place: str
    id: str | None = None


@dataclass(frozen=True)
class Experiment:
    """Default experiment: start and stop time and the base step size that an annotation gives. [s]"""

    start_time: float = 0.0
    stop_time: float | None = None
    step_size: float | None = None


@dataclass(frozen=True)
class Structure:
    """A whole SSD file.

    Parameters
    ----------
    name, version : str
        As stated at its top.
    system : SystemElement
        The outermost system.
    experiment : Experiment
        Default experiment.
    units : mapping of str to Unit
        Defined in the file.
    enumerations : mapping of str to mapping of str to int
        Defined in the file: items by name.
    document : Document
        The XML.
    """

    name: str
    version: str
    system: SystemElement
    experiment: Experiment
    units: Mapping[str, Unit]
    enumerations: Mapping[str, Mapping[str, int]]
    document: Document
