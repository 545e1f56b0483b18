"""A system structure while causes are put into it: values, inserted components, and what could not be done."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from shipcosim import library
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.series import conversion
from shipcosim.ssp import SystemStructure, Variable, parameter
from shipcosim.ssp.read.parameters import ParameterValue

AXES = ("X", "Y", "N")


class Estimated(NamedTuple):
    """A value with its standard deviation, or 0 without one."""

    value: float
    std: float = 0.0


def converted(estimate: ParameterEstimate, unit: str) -> Estimated:
    """An estimate in another unit."""
    factor, offset = conversion(estimate.unit, unit)
    return Estimated(factor * estimate.estimate + offset, abs(factor) * estimate.std)


@dataclass
class ExtensionDraft:
    """A system structure that is being extended, and what went into it so far.

    Attributes
    ----------
    structure : SystemStructure
        Changed in place.
    ship : str
        Full name of the vessel.
    log : mapping
        Attributes of the log.
    values : dict of str to ParameterValue
        By signal.
    inserted, remarks : list of str
    moved : bool
        Whether a current has been put into it.
    shows, suffix : str
        Component whose outputs are what the log shows, and what their names end in.
    errors : dict of str to float
        Errors of the instruments but their lag, by field of `InstrumentParameters`.
    lag : float
        Lag of the instruments. [s]
    """

    structure: SystemStructure
    ship: str
    log: Mapping[str, Any]
    values: dict[str, ParameterValue] = field(default_factory=dict)
    inserted: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    moved: bool = False
    shows: str = ""
    suffix: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    lag: float = 0.0

    def __post_init__(self) -> None:
        self.shows = self.ship

    @property
    def around(self) -> str:
        """Prefix of the full names of components beside the ship."""
        return self.ship[: self.ship.rfind(".") + 1]

    def remark(self, finding: Finding, what: str) -> None:
        """Record a deviation from the finding."""
        self.remarks.append(f"{finding.label}: {what}.")

    def thrusters(self, variable: str = "rpm_in") -> list[str]:
        """Components that load the ship and have a variable."""
        sources = [
            source
            for source, target in self.structure.connections
            if target.startswith(f"{self.ship}.tau_")
        ]
        names = dict.fromkeys(source.rpartition(".")[0] for source in sources)
        parts = self.structure.components
        return [name for name in names if name in parts and variable in parts[name].variables]

    def variable(self, place: str, name: str) -> Variable | None:
        """A variable of a component; None where there is none such."""
        parts = self.structure.components
        return parts[place].variables.get(name) if place in parts else None

    def put(
        self, finding: Finding, signal: str, given: Estimated, unit: str | None, *, note: str = ""
    ) -> None:
        """Give a signal a value in the set."""
        # Where a value comes from, for the set.
        log = self.log
        sizes = ", ".join(
            f"{name} {e.estimate:.4g} ± {e.std:.2g} {e.unit}"
            for name, e in finding.parameters.items()
        )
        source = Path(str(log["source"])).name if log.get("source") else "a log"
        digest = f", SHA-256 {log['sha256']}" if log.get("sha256") else ""
        how = "as learned beside the others of this set"
        if sizes:
            how = f"named with probability {finding.probability:.2f}: {sizes}"
        origin = f"{finding.label}, {how}; from {source}{digest}"
        text = "; ".join(filter(None, (note, origin)))
        unit = None if unit in (None, "", "1") else unit
        self.values[signal] = parameter(
            signal, float(given.value), unit, text, tolerance=given.std or None
        )

    def put_parameter(
        self, finding: Finding, place: str, name: str, estimate: ParameterEstimate
    ) -> None:
        """Give a parameter of a component its estimate, in the FMU's unit; a remark where there is none such."""
        variable = self.variable(place, name)
        if variable is None:
            what = (
                f"'{place}' has no parameter '{name}'"
                if place in self.structure.components
                else f"there is no component '{place}'"
            )
            self.remark(finding, f"{what}, so it is not carried")
            return
        given = converted(estimate, variable.unit or "1")
        self.put(finding, f"{place}.{name}", given, variable.unit, note=variable.description)

    def insert(self, fmu: str, name: str) -> str:
        """Add a component of one of our FMUs beside the ship; its full name."""
        path = self._fmu(fmu)
        taken = set(self.structure.elements)
        names = (
            f"{self.around}{name}{number}" for number in ("", *(f"_{k}" for k in range(2, 100)))
        )
        full = next(candidate for candidate in names if candidate not in taken)
        self.structure.add_component(full, path)
        self.inserted.append(full)
        return full

    def _fmu(self, name: str) -> Path:
        """File of one of our FMUs: beside those of the system, else built."""
        folders = [part.fmu.path.parent for part in self.structure.components.values()]
        file = next(
            (folder / f"{name}.fmu" for folder in folders if (folder / f"{name}.fmu").is_file()),
            None,
        )
        return file or library.find("fmu", name)

    def load(self, component: str) -> bool:
        """Connect a component's loads to a free input of the ship; return True if there is one."""
        used = {target for _, target in self.structure.connections} | {
            source for source, _ in self.structure.connections
        }
        variables = self.structure.components[self.ship].variables
        # The first of the ship's load inputs whose three axes are all unused.
        for number in range(1, 100):
            inputs = [f"tau_{axis}_{number}" for axis in AXES]
            if not all(name in variables for name in inputs):
                return False
            if not any(f"{self.ship}.{name}" in used for name in inputs):
                for axis, name in zip(AXES, inputs, strict=True):
                    self.structure.connect(f"{component}.tau_{axis}", f"{self.ship}.{name}")
                return True
        return False

    def drop(self, component: str) -> None:
        """Take an inserted component out again."""
        self.structure.remove(component)
        self.inserted.remove(component)

    def release(self, input_name: str) -> None:
        """Disconnect an input from whatever feeds it."""
        if any(input_name in pair for pair in self.structure.connections):
            self.structure.disconnect(input_name)
