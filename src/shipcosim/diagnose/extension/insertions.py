"""Components that the extended system gets where it lacks a cause: forces, a current, instruments."""

from collections.abc import Mapping
from dataclasses import fields
from math import atan2, hypot

from shipcosim.diagnose.extension.draft import Estimated, ExtensionDraft, converted
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.cause import ExtensionRule
from shipcosim.diagnose.ship.environment import water_of
from shipcosim.models.core.motion import Motion
from shipcosim.models.ship.instruments import InstrumentParameters

RAMP = 30.0
"""Time over which something grows after its onset, assumed. [s]"""

_Vector = tuple[Estimated, Estimated]


def add_force(
    draft: ExtensionDraft,
    finding: Finding,
    rule: ExtensionRule,
    estimates: Mapping[str, ParameterEstimate],
) -> None:
    """Insert an FMU whose loads are added to those on the ship.

    Parameters
    ----------
    draft : ExtensionDraft
        Changed.
    finding : Finding
    rule : ExtensionRule
    estimates : dict of str to Estimate
        By parameter of the FMU.
    """
    name = draft.insert(rule.insert, finding.cause)
    if not draft.load(name):
        draft.drop(name)
        draft.remark(finding, f"'{draft.ship}' has no free load input, so it is not carried")
        return
    for into, output in rule.inputs.items():
        draft.structure.connect(f"{draft.ship}.{output}", f"{name}.{into}")
    zeros = {
        parameter: ParameterEstimate(0.0, 0.0, _unit(draft, name, rule.zero[0]))
        for parameter in rule.zero
    }
    for parameter, estimate in (zeros | dict(estimates)).items():
        draft.put_parameter(finding, name, parameter, estimate)
    # Parameters without an estimate get the assumed values of the ship model's water.
    water = water_of(float(draft.structure.parameters[f"{draft.ship}.length"] or 0.0))
    numbers = {
        parameter: number.rpartition(".")[2] for number, parameter in rule.parameters.items()
    }
    for parameter, why in rule.assumed.items():
        if parameter not in estimates:
            given = Estimated(getattr(water, numbers[parameter]))
            draft.put(
                finding, f"{name}.{parameter}", given, _unit(draft, name, parameter), note=why
            )
    if finding.onset is not None and rule.onset:
        start, growth = rule.onset
        draft.put(finding, f"{name}.{start}", Estimated(finding.onset), "s")
        draft.put(finding, f"{name}.{growth}", Estimated(RAMP), "s", note="assumed")


def _unit(draft: ExtensionDraft, component: str, parameter: str) -> str:
    return draft.structure.components[component].variables[parameter].unit or "1"


def add_instruments(
    draft: ExtensionDraft,
    finding: Finding,
    estimates: Mapping[str, ParameterEstimate],
) -> None:
    """Put instruments with some errors between the ship and her log.

    Parameters
    ----------
    draft : ExtensionDraft
        Changed.
    finding : Finding
    estimates : dict of str to Estimate
        By field of `InstrumentParameters`.
    """
    if not draft.suffix:
        draft.shows = draft.insert("instruments", "instruments")
        draft.suffix = "_meas"
        for name in Motion._fields:
            draft.structure.connect(f"{draft.ship}.{name}", f"{draft.shows}.{name}")
    units = {item.name: item.metadata["unit"] for item in fields(InstrumentParameters)}
    for name, estimate in estimates.items():
        given = converted(estimate, units[name])
        draft.put(finding, f"{draft.shows}.{name}", given, units[name])
        if name == "lag":
            draft.lag = given.value
        else:
            draft.errors[name] = given.value


def add_current(
    draft: ExtensionDraft, finding: Finding, start: _Vector | None, end: _Vector | None = None
) -> None:
    """Make the water move.

    Parameters
    ----------
    draft : ExtensionDraft
        Changed.
    finding : Finding
        One with an onset gets a current that grows from then on.
    start : tuple of two Estimated or None
        North and east, steady without an `end`, else at the log's first row; None where it only grows at the onset.
        [m/s]
    end : tuple of two Estimated, optional
        At the log's last row, or after the onset. [m/s]
    """
    source = _water(draft)
    if draft.moved:
        draft.remark(finding, "the water moves already by another finding, so it is not carried")
        return
    draft.moved = True
    if end is None:
        if start is not None:
            _steady(draft, finding, source, *start)
        return
    if source is None:
        source = _environment(draft)
    span = draft.log.get("span")
    # From the onset on the current grows for an assumed time; else it varies over the log.
    if start is None and finding.onset is not None:
        span = finding.onset, finding.onset + RAMP
    if span is None:
        span = draft.structure.start_time, draft.structure.stop_time or 600.0
        draft.remark(
            finding, f"the log's span is not known; it varies from {span[0]:g} to {span[1]:g} s"
        )
    # A component that varies the current between its ends over that time.
    ends = {"end": end} if start is None else {"start": start, "end": end}
    name = draft.insert("varying_current", "varying_current")
    for output in ("current_speed", "current_to"):
        draft.release(f"{source}.{output}")
        draft.structure.connect(f"{name}.{output}", f"{source}.{output}")
    for label, vector in ends.items():
        for axis, given in zip(("north", "east"), vector, strict=True):
            draft.put(finding, f"{name}.{axis}_{label}", given, "m/s")
    for label, time in zip(("start", "end"), span, strict=True):
        draft.put(finding, f"{name}.time_{label}", Estimated(time), "s", note="of the log")


def _water(draft: ExtensionDraft) -> str | None:
    """Component that gives the current from speed and direction, or None."""
    feeding = {
        connection.target: connection.source for connection in draft.structure.checked().connections
    }
    source, _ = feeding.get((draft.ship, "current_north"), (None, ""))
    variables = draft.structure.components[source].variables if source else {}
    return source if {"current_speed", "current_to"} <= set(variables) else None


def _environment(draft: ExtensionDraft) -> str:
    """Insert an environment that only moves the water."""
    name = draft.insert("environment", "water")
    for axis in ("north", "east"):
        draft.release(f"{draft.ship}.current_{axis}")
        draft.structure.connect(f"{name}.current_{axis}", f"{draft.ship}.current_{axis}")
    return name


def _steady(
    draft: ExtensionDraft, finding: Finding, source: str | None, north: Estimated, east: Estimated
) -> None:
    """Set a constant velocity of the water, at the place where the system has it."""
    if source is None:
        for axis, given in (("north", north), ("east", east)):
            _start(draft, finding, draft.ship, f"current_{axis}", given, "m/s")
        return
    # Speed and direction with standard deviations by the delta method.
    speed = hypot(north.value, east.value)
    along = hypot(north.value * north.std, east.value * east.std) / (speed or 1.0)
    across = hypot(east.value * north.std, north.value * east.std) / (speed * speed or 1.0)
    _start(draft, finding, source, "current_speed", Estimated(speed, along), "m/s")
    _start(
        draft,
        finding,
        source,
        "current_to",
        Estimated(atan2(east.value, north.value), across),
        "rad",
    )


def _start(
    draft: ExtensionDraft, finding: Finding, component: str, name: str, given: Estimated, unit: str
) -> None:
    """Start value of an input: at the system's own input where that feeds it, else at the component."""
    system = draft.structure.checked()
    target = (component, name)
    feeding = next((c for c in system.connections if c.target == target), None)
    # The system's own input takes the value where it feeds this one by a linear connection;
    # otherwise nothing feeds it from here on.
    if (
        feeding is None
        or feeding.source[0] is not None
        or feeding.mapping is not None
        or feeding.factor == 0.0
    ):
        draft.release(f"{component}.{name}")
        draft.put(finding, f"{component}.{name}", given, unit)
        return
    # Invert the connection's factor and offset.
    signal = system.inputs[feeding.source[1]]
    value = (given.value - feeding.offset) / feeding.factor
    draft.put(finding, signal.name, Estimated(value, given.std / abs(feeding.factor)), signal.unit)
    draft.remark(finding, f"a table that feeds the input '{signal.name}' overrides it")
