"""Channels of thrusters and wind that keep a value which was not measured: only the ship's response shows it.

A thruster that stands still keeps its value too. So the held rows are cut out, and the ship has to be explained by the
others. Then no cause may explain all rows as they are logged.
"""

from dataclasses import replace

import numpy as np
import xarray

from shipcosim.diagnose.explanation.search import explain
from shipcosim.diagnose.explanation.unmodelled import unmodelled_gains
from shipcosim.diagnose.finding import Finding, log_fault
from shipcosim.diagnose.inference.fitting import IdentificationProblem, prepared
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.parts import explained
from shipcosim.diagnose.inference.thresholds import UNMODELLED
from shipcosim.diagnose.log.checks.samples import HELD, LIFELESS, held_segments, is_constant
from shipcosim.diagnose.log.mislabels import drive_channels
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.log_faults.thresholds import CALM_AIR, HELD_ALIKE, HELD_EXCESS, IDLE
from shipcosim.diagnose.ship.inputs import with_inputs_of
from shipcosim.diagnose.ship.measured_motion import wind_over_ground
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import dp_thruster_of
from shipcosim.models.core.motion import Motion

_WIND = ("wind_speed", "wind_from", "true_wind_speed", "true_wind_from")


def held_inputs(log: xarray.Dataset, model: ShipModel) -> list[Finding]:
    """Gaps that channels of thrusters and wind would have if they were not measured where they keep a value.

    Parameters
    ----------
    log : xarray.Dataset
        Repaired.
    model : ShipModel
    """
    time = log["logged_time"].values
    drives = [role for name in model.thrusters for role in drive_channels(name, log)]
    roles = [*drives, *(role for role in _WIND if role in log)]
    held = {
        role: tuple(
            segment
            for segment in held_segments(time, log[role].values)
            if not _idles(log, role, inside(time, [segment]), model)
            and not _is_calm(log, role, inside(time, [segment]))
        )
        for role in roles
    }
    findings = {}
    # A wind that is the same in every row is none that was measured: she meets another one as she moves.
    wind = tuple(role for role in _WIND[:2] if role in log)
    is_still = any(is_constant(log[role].values) for role in wind)
    if is_still and not _is_calm(log, wind[0], slice(None)):
        whole = (float(time[0]), float(time[-1]))
        findings[wind] = log_fault("gap", wind, LIFELESS, (whole,), 0.99)
    for role, segments in held.items():
        if not segments or any(role in channels for channels in findings):
            continue
        # What is held together, as all channels of a thruster whose line is lost, is one gap.
        here = inside(time, segments)
        together = tuple(
            other
            for other, others in held.items()
            if others and (here & inside(time, others)).sum() > HELD_ALIKE * here.sum()
        )
        findings[together] = log_fault("gap", together, HELD, segments, 0.99)
    return list(findings.values())


def _idles(log: xarray.Dataset, role: str, here: np.ndarray, model: ShipModel) -> bool:
    """Whether a role is the direction of a thruster whose shaft hardly turns in some rows: it pushes in none.

    A shaft that stands in each of these rows is no such one: speed and direction may be held together.
    """
    thruster, _, quantity = role.rpartition("_")
    if quantity != "azimuth" or f"{thruster}_rpm" not in log:
        return False
    speed = np.abs(log[f"{thruster}_rpm"].values[here])
    most = 60.0 * dp_thruster_of(model, thruster).most
    return bool(np.nanmedian(speed) < IDLE * most and not is_constant(speed))


def _is_calm(log: xarray.Dataset, role: str, here: np.ndarray | slice) -> bool:
    """Whether a role is of the wind felt in some rows, and all that is felt there is the ship's own way in calm air."""
    if role not in _WIND[:2] or any(name not in log for name in (*_WIND[:2], "surge", "sway")):
        return False
    speed, felt_from, surge, sway = (
        log[name].values[here] for name in (*_WIND[:2], "surge", "sway")
    )
    # Her place and heading do not matter for the size of the wind.
    motion = Motion(0.0, 0.0, 0.0, surge, sway, 0.0)
    over_ground = np.hypot(*wind_over_ground(speed, np.radians(felt_from), motion))
    return bool(np.nanmedian(over_ground) < CALM_AIR * np.nanmedian(np.hypot(surge, sway)))


def is_contradicted(finding: Finding, log: xarray.Dataset, problem: IdentificationProblem) -> bool:
    """Whether no cause explains the held rows as they are logged, while the others are explained.

    Parameters
    ----------
    finding : Finding
        As from `held_inputs`.
    log : xarray.Dataset
        Repaired, the gap not cut out.
    problem : IdentificationProblem
        Of the log with the gap cut out.
    """
    # The other rows have to be explained: else the model is wrong, and not a channel.
    fit = explain(problem, most=1)[0]
    if max(unmodelled_gains(problem, fit).values()) > UNMODELLED:
        return False
    logged = np.interp(problem.record.time, log["time"].values, log["logged_time"].values)
    usual = _squares(problem, fit)[~inside(logged, finding.segments)].mean()
    # All rows as logged, with the cause that explains these best and with the same noise.
    record = with_inputs_of(problem.record, log, problem.model)
    rival = explain(prepared(replace(problem, record=record)), most=1)[0]
    return bool(0.5 * (_squares(problem, rival) - usual).sum() > HELD_EXCESS)


def _squares(problem, fit):
    """Squared innovations of each row with a fit."""
    return innovations(explained(fit.linear, fit.left), problem.noise, fit.record).squares
