"""The contents of an FMU's modelDescription.xml: the FMU and its variables as records.

Reference: FMI 1.0 for co-simulation and for model exchange, FMI 2.0.4 and FMI 3.0.1, section 2 of each.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from shipcosim.ssp.xml.document import is_true
from shipcosim.ssp.xml.values import KINDS, Value
from shipcosim.units import Unit


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
    required : bool
        A parameter whose start value stands for none, as an FMU of ours says it: the FMU refuses to start with it.
    optional : bool
        An input that may stay unconnected, as an FMU of ours says it.
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
    start: Value | None = None
    minimum: float | None = None
    maximum: float | None = None
    description: str = ""
    items: Mapping[str, int] = field(default_factory=dict)
    dimensions: tuple[int, ...] = ()
    sizes: tuple[int | str, ...] = ()
    negated: bool = False
    required: bool = False
    optional: bool = False
    whole: "Variable | None" = None
    place: int = 0

    @property
    def kind(self) -> str:
        """Kind of the type: Real, Integer, Boolean, String, Enumeration, Binary or Clock."""
        return KINDS[self.type]

    @property
    def settable(self) -> bool:
        """Whether a start value may be set from outside before initialisation."""
        given = self.causality in ("input", "parameter", "structuralParameter") or self.initial in (
            "exact",
            "approx",
        )
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
        For model exchange; an FMU of FMI 3.0 is asked for its states while it runs, and lists its indicators.
    arrays : mapping of str to tuple of int
        Dimensions of the arrays whose elements stand in `variables` in their place.
    """

    path: Path
    fmi_version: str
    model_name: str
    token: str
    variables: Mapping[str, Variable]
    description: str = ""
    generation_tool: str = ""
    interfaces: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    units: Mapping[str, Unit] = field(default_factory=dict)
    platforms: tuple[str, ...] = ()
    experiment: Mapping[str, float] = field(default_factory=dict)
    n_states: int = 0
    n_event_indicators: int = 0
    arrays: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    def capability(self, name: str, interface: str = "CoSimulation") -> bool:
        """Truth of a capability flag, e.g. ``"canGetAndSetFMUstate"``; false where it is not given."""
        return is_true(self.interfaces.get(interface, {}).get(name))

    @property
    def model_identifier(self) -> str:
        """Name of the co-simulation binary without its ending; empty where there is none."""
        return self.identifier("CoSimulation")

    def identifier(self, interface: str) -> str:
        """Name of the binary of one form, without its ending; empty where it does not offer this form."""
        return self.interfaces.get(interface, {}).get("modelIdentifier", "")

    def named(self, *causalities: str) -> list[str]:
        """Names of the variables of these causalities."""
        return [
            variable.name
            for variable in self.variables.values()
            if variable.causality in causalities
        ]
