"""The named causes as part of the system: values in extended.ssv, and in extended.ssp what the system did not have."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.extension.connections import connect_neighbours, put_on_connections, rewire
from shipcosim.diagnose.extension.draft import Estimated, ExtensionDraft, converted
from shipcosim.diagnose.extension.insertions import add_current, add_force, add_instruments
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue, read_faults
from shipcosim.diagnose.hypotheses.cause import Cause, ExtensionRule, OnConnections
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.errors import error_at
from shipcosim.ssp import AnyPath, SystemStructure, read, write_ssv

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
        Errors of the instruments, as `shipcosim.models.ship.instruments.true_motion` takes them to find the state from
        which a run from a logged row starts.
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


def extend(
    system: str | Path | SystemStructure,
    findings: Iterable[Finding],
    folder: AnyPath,
    craft: LearnedCraft | None = None,
    *,
    log_attributes: Mapping[str, Any] | None = None,
    catalogue: Mapping[str, Cause] | None = None,
) -> Extension:
    """Write a system that has the named causes of the physics in it, and only those.

    Parameters
    ----------
    system : path or SystemStructure
        As for `shipcosim.read`; not changed.
    findings : iterable of Finding
        Those of kind ``"data"`` are passed over.
    folder : path
        Gets extended.ssp and extended.ssv.
    craft : LearnedCraft, optional
        The ship as logs taught her: her numbers go into the set.
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
    structure = structure_of(system)
    draft = ExtensionDraft(structure, _ship(structure), log_attributes or {})
    catalogue = catalogue or read_catalogue()
    findings = [finding for finding in findings if finding.kind == "physics"]
    # All edits of the structure together: it is checked only after the last.
    with structure.changes():
        if craft is not None:
            _put_craft(draft, craft)
            findings = [
                finding
                for finding in findings
                if catalogue[finding.cause].sought_in != "comparison"
            ]
        for finding in findings:
            _carry(draft, finding, catalogue)
    ssp = Path(folder) / "extended.ssp"
    ssv = Path(folder) / "extended.ssv"
    write_ssv(ssv, "extended", draft.values.values())
    structure.bind(ssv)
    structure.write(ssp)
    return Extension(
        ssp,
        ssv,
        {name: value.value for name, value in draft.values.items()},
        tuple(draft.inserted),
        signals_of(draft.shows, draft.suffix),
        draft.errors,
        draft.lag,
        tuple(draft.remarks),
    )


def structure_of(system: str | Path | SystemStructure) -> SystemStructure:
    """A structure to change: a copy of the given one, or that in a file."""
    return system.copy() if isinstance(system, SystemStructure) else read(system)


def signals_of(component: str, suffix: str = "") -> dict[str, str]:
    """By role: the signal of a ship or of her instruments that shows what the log should."""
    return {role: f"{component}.{name}{suffix}" for role, name in _SHOWN.items()}


def _ship(structure: SystemStructure) -> str:
    """Name of the component that all forces act on."""
    needed = {"tau_X_1", "tau_Y_1", "tau_N_1", "psi", "current_north", "current_east"}
    ships = [
        name
        for name, part in structure.checked().components.items()
        if needed <= set(part.variables)
    ]
    if len(ships) != 1:
        message = f"{len(ships)} components that loads can act on" + (
            f": {', '.join(ships)}." if ships else "."
        )
        remedy = "To extend it, a system needs one vessel, with inputs tau_X_1, tau_Y_1, tau_N_1, current_north, ..."
        raise error_at(structure.name, message, remedy)
    return ships[0]


def _carry(draft: ExtensionDraft, finding: Finding, catalogue: Mapping[str, Cause]) -> None:
    """Put one finding into the system."""
    # Faults that are wrong connections of the system are corrected by connecting anew.
    fault = read_faults().get(finding.cause)
    if fault is not None and fault.rewires:
        rewire(draft, str(finding.component))
        return
    if finding.cause not in catalogue:
        draft.remark(finding, "it is not in the catalogue")
        return
    cause = catalogue[finding.cause]
    # Numbers that a rule inserts as a component are taken out; the rest become parameters.
    numbers = _numbers(draft, finding, cause)
    with_onset = False
    for rule in _rules(cause, numbers):
        estimates = {
            parameter: numbers.pop(number)
            for number, parameter in rule.parameters.items()
            if number in numbers
        }
        with_onset |= _insert(draft, finding, rule, estimates)
        if rule.neighbour_inputs:
            places = (number.rpartition(".")[0] for number in numbers)
            connect_neighbours(draft, finding, rule, dict.fromkeys(places))
        if rule.by == "log":
            draft.remark(finding, "it is one of the log, not of the ship: shift the channels")
            numbers.clear()
    for number, estimate in numbers.items():
        _put_parameter(draft, finding, number, estimate, cause)
    # Only inserted components can begin at the onset; a parameter holds for the whole run.
    if finding.onset is not None and not with_onset:
        draft.remark(
            finding,
            f"when it begins, at {finding.onset:.0f} s, and how it goes on are not carried: it acts from the start",
        )


def _put_craft(draft: ExtensionDraft, craft: LearnedCraft) -> None:
    """Put the numbers of a craft into the components that have them."""
    learned = Finding("craft", None, probability=1.0)
    for path, value in craft.after.items():
        place, _, name = path.rpartition(".")
        variable = draft.variable(place, name)
        unit = variable.unit if variable is not None and variable.unit else "1"
        draft.put_parameter(learned, place, name, ParameterEstimate(value, craft.std[path], unit))


def _numbers(draft: ExtensionDraft, finding: Finding, cause: Cause) -> dict[str, ParameterEstimate]:
    """Numbers of the ship that a finding has estimates for."""
    numbers = {}
    for name, estimate in finding.parameters.items():
        # Some causes state what is lost; the parameter is what remains.
        parameter = cause.parameters.get(name)
        if parameter is not None and parameter.complement:
            estimate = replace(estimate, estimate=1.0 - estimate.estimate)
        for pattern in parameter.of if parameter is not None else ():
            paths = _paths(draft, pattern, finding)
            is_factor = parameter is not None and parameter.factor
            numbers |= (
                _multiplied(draft, paths, estimate) if is_factor else dict.fromkeys(paths, estimate)
            )
    return numbers


def _multiplied(
    draft: ExtensionDraft, paths: Iterable[str], factor: ParameterEstimate
) -> dict[str, ParameterEstimate]:
    """Numbers of the system times a factor; those that are 0, or that the system does not have, are left out."""
    scaled = {}
    for path in paths:
        place, _, name = path.rpartition(".")
        variable = draft.variable(place, name)
        if variable is None:
            continue
        value = draft.structure.components[place].start_value(name)
        if isinstance(value, int | float) and value != 0.0:
            size = factor.estimate * value, factor.std * abs(value)
            scaled[path] = ParameterEstimate(*size, variable.unit or "1")
    return scaled


def _rules(cause: Cause, numbers: Mapping[str, ParameterEstimate]) -> list[ExtensionRule]:
    """How the system gets a cause: as its file says, else as causes of ours on the same numbers."""
    if cause.extension is not None:
        return [cause.extension]
    ours = [
        definition.extension
        for definition in read_catalogue().values()
        if definition.extension is not None
    ]
    return [rule for rule in ours if set(rule.parameters) & set(numbers)]


def _insert(
    draft: ExtensionDraft,
    finding: Finding,
    rule: ExtensionRule,
    estimates: Mapping[str, ParameterEstimate],
) -> bool:
    """Put what a rule inserts into the system; whether the onset of the cause went along."""
    if not estimates or rule.by in ("parameters", "log"):
        return False
    if rule.by == "instruments":
        add_instruments(draft, finding, estimates)
        return False
    if rule.by == "force":
        add_force(draft, finding, rule, estimates)
    elif rule.by == "steady current":
        steady = _vector(estimates, "north", "east")
        add_current(
            draft, finding, *((None, steady) if finding.onset is not None else (steady, None))
        )
    else:
        add_current(
            draft,
            finding,
            *(_vector(estimates, f"north_{end}", f"east_{end}") for end in ("start", "end")),
        )
    return True


def _vector(
    estimates: Mapping[str, ParameterEstimate], north: str, east: str
) -> tuple[Estimated, Estimated]:
    """North and east of a velocity; a missing one is 0. [m/s]"""
    pair = [
        converted(estimates[name], "m/s") if name in estimates else Estimated(0.0, 0.0)
        for name in (north, east)
    ]
    return pair[0], pair[1]


def _put_parameter(
    draft: ExtensionDraft, finding: Finding, number: str, estimate: ParameterEstimate, cause: Cause
) -> None:
    """Put a number into the component that has it: as a parameter, else on its connections."""
    place, _, name = number.rpartition(".")
    rule = _on_connections(cause).get(name)
    is_there = place in draft.structure.components
    if rule is not None and is_there and draft.variable(place, name) is None:
        put_on_connections(draft, finding, place, estimate, rule)
    else:
        draft.put_parameter(finding, place, name, estimate)


def _on_connections(cause: Cause) -> dict[str, OnConnections]:
    """By number of a thruster: how connections carry it, as the cause's file says or one of ours."""
    parameters = [
        parameter
        for definition in (*read_catalogue().values(), cause)
        for parameter in definition.parameters.values()
    ]
    return {
        of.rpartition(".")[2]: parameter.on_connections
        for parameter in parameters
        if parameter.on_connections
        for of in parameter.of
    }


def _paths(draft: ExtensionDraft, pattern: str, finding: Finding) -> list[str]:
    """Numbers of the ship that a pattern of the catalogue means."""
    if pattern.startswith("vessel."):
        return [f"{draft.ship}.{pattern.removeprefix('vessel.')}"]
    if "{azimuths}" in pattern:
        return [pattern.replace("{azimuths}", name) for name in draft.thrusters("azimuth_in")]
    if "{thrusters}" in pattern:
        return [
            pattern.replace("{thrusters}", name)
            for name in ship_model_of(draft.structure.checked()).thrusters
        ]
    return [pattern.replace("{thruster}", finding.component or "")]
