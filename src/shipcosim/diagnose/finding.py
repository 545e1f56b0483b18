"""What a diagnosis names: causes with their parameters, candidates, and where simulation and log differ."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

Segment = tuple[float, float]
"""First and last time of a part of a log. [s]"""


def label_of(cause: str, component: str | None) -> str:
    """A cause with its place, in words: ``thrust_loss of port``."""
    return f"{cause} of {component}" if component else cause


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter of a cause, with its standard deviation, both in `unit`.

    `given` is what the system says of it, where it is a number of the ship and not one that is 0 or 1 on a ship as
    modelled.
    """

    estimate: float
    std: float
    unit: str
    given: float | None = None

    def as_json(self) -> dict:
        """The estimate as an entry of diagnosis.json; what does not apply is left out."""
        entry = asdict(self)
        if self.given is None:
            del entry["given"]
        return entry


def estimates_as_json(estimates: Mapping[str, ParameterEstimate]) -> dict[str, dict]:
    """Estimates by parameter, as diagnosis.json has them."""
    return {name: estimate.as_json() for name, estimate in estimates.items()}


@dataclass(frozen=True)
class Finding:
    """One cause that is present.

    Attributes
    ----------
    cause : str
        Name of the cause as in the catalogue.
    component : str or None
        Component of the system that it sits in, where there are several.
    kind : str
        ``"data"``: the log is wrong, or ``"physics"``: the model is.
    probability : float
        That it is right to name it.
    parameters : dict of str to Estimate
        In the units of the catalogue.
    segments : tuple of (float, float)
        Where in the log, from and to; empty is all of it. [s]
    channels : tuple of str
        Roles of the channels that a fault of the data is in.
    onset : float or None
        From when on a cause of the physics acts; None from the start. [s]
    course : str
        What it does after its onset: ``"step"``, it stays; ``"ramp"``, it grows to its size at the end; ``"spell"`` or
        ``"switching"``: it is there in `segments`. Empty: it is there all along.
    note : str
        What else there is to say, one sentence.
    alternatives : tuple of str
        Other readings that explain the log alike, one sentence each. Where there are any, `note` is only the likeliest
        of them, and nothing was corrected.
    at_reference : dict of str to Estimate
        What the parameters were when a reference was made; empty without one, and of what it does not hold.
    logs : tuple of str
        Of several logs, the names of those that show it; empty for a single log.
    put_right : tuple of str
        Names of those that do not show it, and are corrected all the same.
    by_log : dict of str to dict
        By name of the log: the parameters by that log alone.
    mislabel : Mislabel or None
        How channels that are not what their labels say are corrected; None of any other fault, and where a log leaves
        open what is wrong.
    """

    cause: str
    component: str | None = None
    kind: str = "physics"
    probability: float = 1.0
    parameters: dict[str, ParameterEstimate] = field(default_factory=dict)
    segments: tuple[Segment, ...] = ()
    channels: tuple[str, ...] = ()
    onset: float | None = None
    course: str = ""
    note: str = ""
    alternatives: tuple[str, ...] = ()
    at_reference: dict[str, ParameterEstimate] = field(default_factory=dict)
    logs: tuple[str, ...] = ()
    put_right: tuple[str, ...] = ()
    by_log: dict[str, dict[str, ParameterEstimate]] = field(default_factory=dict)
    mislabel: Any = field(default=None, compare=False, repr=False)

    @property
    def label(self) -> str:
        """``thrust_loss of port``."""
        return label_of(self.cause, self.component)

    @property
    def sentence(self) -> str:
        """The note, with what explains the log alike."""
        if not self.alternatives:
            return self.note
        return f"{'; or '.join([self.note, *self.alternatives])}: the log does not tell, nothing is corrected"

    def as_json(self) -> dict:
        """The finding as an entry of diagnosis.json; what does not apply is left out."""
        entry = {key: getattr(self, key) for key in ("cause", "component", "kind", "probability")}
        entry["parameters"] = estimates_as_json(self.parameters)
        if self.at_reference:
            entry["at_reference"] = estimates_as_json(self.at_reference)
        segments = [list(segment) for segment in self.segments]
        if self.kind == "data":
            entry["segments"] = segments
            entry["channels"] = list(self.channels)
        if self.onset is not None:
            entry["onset"] = self.onset
        if self.course:
            entry["course"] = self.course
            entry["segments"] = segments
        if self.note:
            entry["note"] = self.note
        if self.alternatives:
            entry["alternatives"] = list(self.alternatives)
        if self.logs:
            entry["logs"] = list(self.logs)
        if self.put_right:
            entry["put_right_in"] = list(self.put_right)
        if self.by_log:
            entry["by_log"] = {
                name: estimates_as_json(estimates) for name, estimates in self.by_log.items()
            }
        return entry


def log_fault(
    cause: str,
    channels: tuple[str, ...],
    note: str,
    segments: tuple[Segment, ...] = (),
    probability: float = 1.0,
    parameters: dict[str, ParameterEstimate] | None = None,
) -> Finding:
    """The finding that some channels of a log are wrong, in segments or throughout."""
    finding = Finding(cause, None, "data", probability, parameters or {}, segments, channels)
    return replace(finding, note=note)


@dataclass(frozen=True)
class Candidate:
    """A cause with the probability that it is present."""

    cause: str
    component: str | None
    probability: float

    @property
    def label(self) -> str:
        """``thrust_loss of port``."""
        return label_of(self.cause, self.component)


@dataclass(frozen=True)
class VisibleSize:
    """The smallest size of a cause that a log would have shown in nine of ten cases, in `unit`.

    `parameter` is empty where the cause is a vector, as a current: `size` is then its length. `largest` is the
    largest size within the bounds of the cause: where `size` is above it, none would have shown.
    """

    cause: str
    component: str | None
    parameter: str
    size: float
    unit: str
    largest: float


@dataclass(frozen=True)
class Discrepancy:
    """A difference between simulation and log, before any cause is sought.

    Attributes
    ----------
    what : str
        In words, with its size.
    component, axis : str or None
        Thruster, and ``"surge"``, ``"sway"`` or ``"yaw"``, where it is of one.
    estimate, std : float
    unit : str
    share : float
        Of the error that it explains.
    logs : tuple of str
        Of several logs, the names of those that show it; empty for a single log.
    """

    what: str
    component: str | None
    axis: str | None
    estimate: float
    std: float
    unit: str
    share: float
    logs: tuple[str, ...] = ()

    def as_json(self) -> dict:
        """The discrepancy as an entry of diagnosis.json; what does not apply is left out."""
        entry = asdict(self)
        if not self.logs:
            del entry["logs"]
        return entry
