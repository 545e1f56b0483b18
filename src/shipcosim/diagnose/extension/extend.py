"""The named causes as part of the system: values in extended.ssv, and in extended.ssp what the system did not have."""

from dataclasses import dataclass, field
from pathlib import Path

from shipcosim.diagnose.extension.connection_edits import put_on_connections
from shipcosim.diagnose.extension.structure_edits import (
    Estimated,
    StructureEdits,
    add_current,
    add_force,
    add_instruments,
    add_slipstreams,
    rewire,
)
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.series import conversion
from shipcosim.ssp import SystemStructure, read, write_ssv

_FORCES = {"drift": "drift_force", "tow": "earth_force"}
_SHOWN = {"north": "x", "east": "y", "heading": "psi", "surge": "u", "sway": "v", "yaw_rate": "r"}


@dataclass(frozen=True)
class Extension:
    """A system with the causes that were named in it.

    Attributes
    ----------
    ssp, ssv : Path
        The system, which has the set bound, and the set: what was named and nothing else.
    values : dict of str to float
        What the set holds, in the units of the FMUs; an input of the system in its own.
    components : tuple of str
        Inserted.
    signals : dict of str to str
        By role (``"north"``, ``"heading"``): the signal of the extended system that shows what the log should.
    errors : dict of str to float
        Errors of the instruments, as `shipcosim.models.ship.instruments.motion_of` takes them to find the state that a
        run from a logged row starts from.
    lag : float
        By how much those signals are late. [s]
    remarks : tuple of str
        What is not as the findings say, or needs to be known.
    """

    ssp: Path
    ssv: Path
    values: dict[str, float]
    components: tuple[str, ...] = ()
    signals: dict[str, str] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    lag: float = 0.0
    remarks: tuple[str, ...] = ()


def extend(system, findings, folder, *, log_attributes=None, catalogue=None):
    """Write a system that has the named causes of the physics in it, and only those.

    Parameters
    ----------
    system : path or SystemStructure
        As for `shipcosim.read`; not changed.
    findings : iterable of Finding
        Those of kind ``"data"`` are passed over.
    folder : path
        Gets extended.ssp and extended.ssv.
    log_attributes : mapping, optional
        Of the log: ``source`` and ``sha256`` go into the descriptions, ``span`` (first and last time, in s) is that
        of a varying current.
    catalogue : dict of str to Cause, optional
        The causes; our own if not given.

    Returns
    -------
    Extension

    Raises
    ------
    ShipcosimError
        If the system has errors or no ship, an FMU to insert is not there, or something cannot be written.
    """
    structure = system.copy() if isinstance(system, SystemStructure) else read(system)
    edits = StructureEdits(structure, _ship(structure), log_attributes or {})
    catalogue = catalogue or read_catalogue()
    findings = [finding for finding in findings if finding.kind == "physics"]
    with structure.changes():
        for finding in findings:
            _carry(edits, finding, catalogue)
    ssp, ssv = Path(folder) / "extended.ssp", Path(folder) / "extended.ssv"
    write_ssv(ssv, "extended", edits.values.values())
    structure.bind(ssv)
    structure.write(ssp)
    return Extension(
        ssp,
        ssv,
        {name: value.value for name, value in edits.values.items()},
        tuple(edits.inserted),
        {role: f"{edits.shows}.{name}" + edits.suffix for role, name in _SHOWN.items()},
        edits.errors,
        edits.lag,
        tuple(edits.remarks),
    )


def _ship(structure):
    """Name of the component that all forces act on."""
    needed = {"tau_X_1", "tau_Y_1", "tau_N_1", "psi", "current_north", "current_east"}
    ships = [name for name, part in structure.checked().components.items() if needed <= set(part.fmu.variables)]
    if len(ships) != 1:
        found = f"{len(ships)} components that loads can act on" + (f": {', '.join(ships)}." if ships else ".")
        remedy = "To extend it, a system needs one vessel, with inputs tau_X_1, tau_Y_1, tau_N_1, current_north, ..."
        raise ShipcosimError(Problem(structure.name, found, remedy))
    return ships[0]


def _carry(edits, finding, catalogue):
    """Put one finding into the system."""
    if finding.cause == "connection":
        rewire(edits, finding.component)
        return
    if finding.cause not in catalogue:
        edits.remark(finding, "it is not in the catalogue")
        return
    known = catalogue[finding.cause].parameters
    numbers = {}
    for name, estimate in finding.parameters.items():
        patterns = known[name].of if name in known else ()
        for path in (path for pattern in patterns for path in _paths(edits, pattern, finding)):
            place, _, number = path.rpartition(".")
            numbers.setdefault(place, {})[number] = estimate
    around = {place: numbers.pop(place, {}) for place in ("water", "instruments")}
    with_onset = _surround(edits, finding, around["water"])
    add_instruments(
        edits, finding, {name: _in(e, edits.unit_of_error(name)) for name, e in around["instruments"].items()}
    )
    for place, values in numbers.items():
        for number, estimate in values.items():
            if not put_on_connections(edits, finding, place, number, estimate):
                edits.put_parameter(finding, place, number, estimate)
    if finding.cause == "thruster_interaction":
        add_slipstreams(edits, finding, [place for place, values in numbers.items() if "interaction_loss" in values])
    if finding.onset is not None and not with_onset:
        edits.remark(finding, f"its onset at {finding.onset:g} s is not carried: it acts from the start")


def _surround(edits, finding, water):
    """Put currents and forces into the system; whether their onset went along."""
    if {"current_north", "current_east"} & set(water):
        ends = _pair(water, "current_north", "current_east", "m/s")
        add_current(edits, finding, *(((None, None), ends) if finding.onset is not None else (ends, None)))
    if any(name.endswith(("_start", "_end")) for name in water):
        ends = [_pair(water, f"north_{end}", f"east_{end}", "m/s") for end in ("start", "end")]
        add_current(edits, finding, *ends)
    for prefix, fmu in _FORCES.items():
        own = {name.removeprefix(f"{prefix}_"): e for name, e in water.items() if name.startswith(f"{prefix}_")}
        if own:
            vector = _pair(own, "north", "east", "N")
            others = {name: e for name, e in own.items() if name not in ("north", "east")}
            add_force(edits, finding, fmu, *vector, others)
    return bool(water)


def _pair(numbers, north, east, unit):
    """North and east of a vector; one that is not given is none."""
    return tuple(_in(numbers[name], unit) if name in numbers else Estimated(0.0, 0.0) for name in (north, east))


def _in(estimate, unit):
    factor, offset = conversion(estimate.unit, unit)
    return Estimated(factor * estimate.estimate + offset, abs(factor) * estimate.std)


def _paths(edits, pattern, finding):
    """Numbers of the ship that a pattern of the catalogue means."""
    if pattern.startswith("vessel."):
        return [f"{edits.ship}.{pattern.removeprefix('vessel.')}"]
    if "{azimuths}" in pattern:
        return [pattern.replace("{azimuths}", name) for name in edits.thrusters("azimuth_in")]
    return [pattern.replace("{thruster}", finding.component or "")]
