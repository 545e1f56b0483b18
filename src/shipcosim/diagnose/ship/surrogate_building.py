"""Surrogates of third-party FMUs: loads over a log, from co-simulations of an FMU alone, and their derivatives.

The FMU runs along the log with what the log says at its inputs, and again with each of them, and each of its
parameters, changed a little. The part of its loads that is proportional to the squared speed of a propeller is a
quadratic law of thrust, which holds for large changes too; the surrogate is linear in the rest.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray

from shipcosim.cosim import RunOptions, simulate
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.surrogate import QuadraticThrust, Surrogate, without_holes
from shipcosim.diagnose.ship.third_party_fmu import (
    DRIVES,
    MOTION,
    ThirdPartyFmu,
    drives_of,
    number_of,
)
from shipcosim.models.core.motion import Motion
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.ssp import Connection, Signal, System

_AXES = ("X", "Y", "N")
_CHANGE = {
    "x": 0.1,
    "y": 0.1,
    "psi": 2e-3,
    "azimuth": 2e-3,
    "r": 1e-3,
}  # m, rad, rad/s: changes for derivatives
_CHANGE |= dict.fromkeys(("u", "v", "u_r", "v_r"), 0.01)  # m/s
_CHANGE_OF_DRIVE = 2e-3  # of the largest speed or thrust
_CHANGE_OF_PARAMETER = 0.1  # of a tolerance
_LEAD = 30.0  # s, in which an FMU settles at what the log begins with
_MOST_STEPS = 250_000  # of all FMUs together
_NEAR = (
    0.05  # of the largest speed, and in rad: for other inputs than these another surrogate is made
)


def with_surrogates(model: ShipModel, record: Record, motion: Motion) -> ShipModel:
    """The ship with surrogates of her third-party FMUs over a log.

    Parameters
    ----------
    model : ShipModel
    record : Record
        Of one log.
    motion : Motion
        Near the measured one.

    Returns
    -------
    ShipModel
        Itself where all is known.
    """
    if not model.third_party:
        return model
    # Build surrogates only where there is none for this log and these inputs.
    units = {name: drives_of(*pair) for name, pair in record.units.items()}
    new = {
        name: fmu
        for name, fmu in model.third_party.items()
        if fmu.surrogate is None or not _fits(fmu.surrogate, record, units.get(name, {}))
    }
    surrogates = surrogates_of(new, record.time, units, motion) if new else {}
    third_party = model.third_party | {
        name: replace(new[name], surrogate=surrogate) for name, surrogate in surrogates.items()
    }
    # Largest speed and its tolerance are known only after the co-simulation.
    parts = dict(model.parts)
    tolerances = dict(model.tolerances)
    for name, foreign in third_party.items():
        if "rpm" in foreign.drives:
            parts[name] = replace(parts[name], rpm_max=foreign.built_surrogate.rpm_max)
            tolerances[f"{name}.rpm_offset"] = 5e-4 * foreign.built_surrogate.rpm_max
    return replace(model, parts=parts, tolerances=tolerances, third_party=third_party)


def _fits(surrogate: Surrogate, record: Record, units: Mapping[str, np.ndarray]) -> bool:
    """True if a surrogate was built for these times and similar inputs."""
    # The record must lie in the times of the surrogate, and its
    # drives must differ little from those it was built with.
    inside = surrogate.rows[0] <= record.time[0] and record.time[-1] <= surrogate.rows[-1] + 1e-6
    clock = without_holes(surrogate.rows, record.time)
    near = {
        kind: _NEAR * max(np.abs(surrogate.about.get(kind, 0.0)).max(), 1.0)
        for kind in ("rpm", "thrust")
    }
    near["azimuth"] = _NEAR
    return inside and all(
        np.sqrt(np.mean((units[kind] - np.interp(clock, surrogate.time, values)) ** 2)) < near[kind]
        for kind, values in surrogate.about.items()
        if kind in DRIVES
    )


def surrogates_of(
    third_party: Mapping[str, ThirdPartyFmu],
    time: np.ndarray,
    units: Mapping[str, Mapping[str, np.ndarray]],
    motion: Motion,
) -> dict[str, Surrogate]:
    """Surrogates of several FMUs, from one co-simulation.

    Parameters
    ----------
    third_party : dict of str to ThirdPartyFmu
    time : (n,) array
        Even, except for holes between stretches. [s]
    units : dict of str to dict of str to (n,) array
        By third-party FMU: what drives it, as `drives_of` gives it.
    motion : Motion
        (n,) arrays, through still water.

    Returns
    -------
    dict of str to Surrogate
    """
    # Inputs of each FMU: the motion in still water, and the drives of its thruster.
    moved = dict(zip(MOTION, (*motion, motion.u, motion.v), strict=True))
    given = {name: {**moved, **units.get(name, {})} for name in third_party}
    runs = [run for name, fmu in third_party.items() for run in _runs(name, fmu, given[name])]
    # Time grid of the co-simulation; holes of the log are closed.
    clock = without_holes(time, time)
    fine = _fine(
        clock, len(runs), max((fmu.step or 0.0 for fmu in third_party.values()), default=0.0)
    )
    fed = {
        name: {q: np.interp(fine, clock, values) for q, values in each.items()}
        for name, each in given.items()
    }
    # Run all copies in one co-simulation, and form the derivatives of each FMU from its copies.
    table = _simulated(runs, third_party, fed, fine)
    return {
        name: _surrogate(fmu, [run for run in runs if run.of == name], table, fine, fed[name], time)
        for name, fmu in third_party.items()
    }


class _Run(NamedTuple):
    """One copy of an FMU, with one input or one parameter changed by something."""

    of: str
    name: str
    quantity: str = ""
    number: str = ""
    by: float = 0.0


def _runs(name: str, fmu: ThirdPartyFmu, given: Mapping[str, np.ndarray]) -> Iterator[_Run]:
    """All copies of an FMU: as it is, and with each of its inputs and parameters changed."""
    # One copy as it is, then one for each input and parameter with a small change.
    yield _Run(name, name)
    for quantity in dict.fromkeys(link.quantity for link in fmu.links):
        by = _CHANGE.get(quantity) or _CHANGE_OF_DRIVE * max(np.abs(given[quantity]).max(), 1.0)
        yield _Run(name, f"{name} with another {quantity}", quantity, by=by)
    for number, variable in fmu.parameters.items():
        by = _CHANGE_OF_PARAMETER * fmu.component.tolerances[variable]
        yield _Run(name, f"{name} with another {variable}", number=number, by=by)


def _fine(time: np.ndarray, runs: int, step: float) -> np.ndarray:
    """Times of the run: a quarter of the rows' step or the system's own, coarser where there are many copies."""
    # Step: a quarter of a row, not below the system's, and
    # coarser if all copies together take too many steps.
    row = time[1] - time[0]
    span = time[-1] - time[0]
    wanted = max(0.25 * row, step, min(row, runs * span / _MOST_STEPS))
    h = step * max(int(wanted / step + 1e-6), 1) if step else wanted
    return time[0] + h * np.arange(int(np.ceil(span / h - 1e-6)) + 1)


def _simulated(
    runs: Sequence[_Run],
    third_party: Mapping[str, ThirdPartyFmu],
    fed: Mapping[str, Mapping[str, np.ndarray]],
    fine: np.ndarray,
) -> xarray.Dataset:
    """Table of a co-simulation of all copies, settled beforehand; rows are those of the times and one more."""
    # Time before the log in which the FMUs settle at its first inputs.
    h = fine[1] - fine[0]
    lead = int(np.ceil(_LEAD / h))
    components = {}
    connections = []
    inputs = {}
    columns = {}
    # Each copy gets the parameters and connections of the FMU, with its own change.
    for run in runs:
        fmu = third_party[run.of]
        start = dict(fmu.component.start)
        if run.number:
            variable = fmu.parameters[run.number]
            start[variable] = number_of(fmu.component, variable) + run.by
        components[run.name] = replace(fmu.component, name=run.name, start=start, step_size=None)
        # The change of an input is an offset of its connection.
        for link in fmu.links:
            place = f"{run.of} {link.quantity}"
            off = link.factor * run.by if link.quantity == run.quantity else 0.0
            connections.append(
                Connection((None, place), (run.name, link.variable), link.factor, link.offset + off)
            )
            inputs[place] = Signal(place, "Real")
            columns[place] = np.concatenate(
                [np.full(lead, fed[run.of][link.quantity][0]), fed[run.of][link.quantity]]
            )
    # Input table: the first value during settling, then the log.
    clock = h * np.arange(lead + fine.size + 1)
    table = make_table(
        clock, [(name, np.append(values, values[-1]), "", "") for name, values in columns.items()]
    )
    system = System("parts alone", "parts alone", components, tuple(connections), inputs)
    simulated = simulate(
        system, Scenario(stop_time=float(clock[-1]), step_size=float(h)), RunOptions(inputs=table)
    )
    return simulated.isel(
        time=slice(lead + 1, None)
    )  # what a step makes of a row is there at its end


def _surrogate(
    fmu: ThirdPartyFmu,
    runs: Sequence[_Run],
    table: xarray.Dataset,
    fine: np.ndarray,
    fed: Mapping[str, np.ndarray],
    rows: np.ndarray,
) -> Surrogate:
    """The surrogate of a third-party FMU from the runs of its copies."""
    # Finite differences: load of the changed copy less that of the unchanged one, over the change.
    base, *others = (_on_ship(fmu, run.name, table) for run in runs)
    quantities = [run.quantity for run in runs if run.quantity]
    nominal = {n: number_of(fmu.component, v) for n, v in fmu.parameters.items()}
    rest = np.stack(
        [base, *((other - base) / run.by for other, run in zip(others, runs[1:], strict=True))]
    )
    about = {q: fed[q] for q in quantities}
    thrust = QuadraticThrust()
    most = 1.0
    # Separate the quadratic thrust law, and its slopes, from load and derivatives.
    if "rpm" in about:
        top = next(
            fmu.component.variables[x.variable].maximum for x in fmu.links if x.quantity == "rpm"
        )
        factor = next(link.factor for link in fmu.links if link.quantity == "rpm")
        # Largest speed of the FMU's own bounds, if these are plausible, else of the log.
        logged = float(max(np.abs(fed["rpm"]).max(), 1.0))
        most = max(abs(top / factor), logged) if top and np.isfinite(top) and top < 1e6 else logged
        thrust = fitted_thrust(base, fed["rpm"], fed["azimuth"], "azimuth" in about)
        ideal = thrust.loads(fed["rpm"], fed["azimuth"])
        rest[0] -= ideal[0]
        for quantity, slopes in zip(("rpm", "azimuth"), ideal[1:], strict=True):
            if quantity in about:
                rest[1 + quantities.index(quantity)] -= slopes
    return Surrogate(fine, about, nominal, rest, thrust, most, rows)


def _on_ship(fmu: ThirdPartyFmu, name: str, table: xarray.Dataset) -> np.ndarray:
    """Load of a copy on the ship, (3, k) array."""
    load = np.zeros((3, table.sizes["time"]))
    for axis, output, factor, offset in fmu.loads:
        load[_AXES.index(axis)] += factor * table[f"{name}.{output}"].values + offset
    return load


def fitted_thrust(
    load: np.ndarray, rpm: np.ndarray, azimuth: np.ndarray, turns: bool
) -> QuadraticThrust:
    """The quadratic law of thrust that fits loads best.

    Parameters
    ----------
    load : (3, k) array
        [N, N, N.m]
    rpm, azimuth : (k,) array
        [rpm, rad]
    turns : bool
        Whether the thrust turns with the direction.

    Returns
    -------
    QuadraticThrust
        Without thrust where the loads do not go with the squared speed.
    """
    # Regressor n |n|. Without any speed there is no law.
    square = rpm * np.abs(rpm)
    scale = square @ square
    if scale == 0.0:
        return QuadraticThrust()
    # A fixed thruster's axis is the direction of its
    # mean force; a turning one's follows the azimuth.
    axis = 0.0 if turns else float(np.arctan2(load[1] @ square, load[0] @ square))
    along = np.cos(axis + azimuth) * load[0] + np.sin(axis + azimuth) * load[1]
    # Least-squares coefficient of the force along the axis,
    # then for each sense of rotation with enough data.
    both = along @ square / scale
    ways = [square * where for where in (rpm > 0.0, rpm < 0.0)]
    ahead, astern = (
        max(along @ way / (way @ way), 0.0) if way @ way > 0.01 * scale else both for way in ways
    )
    # A law with negative coefficients is no propeller's.
    if both <= 0.0 or min(ahead, astern) <= 0.0:
        return QuadraticThrust()
    # Lever arm by least squares of N = x Y - y X.
    levers = np.stack([load[1], -load[0]], axis=-1)
    x, y = np.linalg.lstsq(levers, load[2], rcond=1e-6)[0]
    return QuadraticThrust(float(ahead), float(astern), axis, float(x), float(y))
