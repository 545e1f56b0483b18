"""The law of a black box: its loads over a log, from co-simulations of its FMU alone, and what a deviation changes.

The FMU runs along the log with what the log says at its inputs, and again with each of them, and each of its
parameters, a little off. In between stands the bollard law that fits it best, which holds for large deviations too.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from shipcosim.cosim import RunOptions, simulate
from shipcosim.diagnose.ship.third_party_fmu import DRIVES, MOTION, drives_of
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.ssp import Connection, Signal, System

__all__ = ["Bollard", "Surrogate", "with_surrogates", "surrogates_of"]

_AXES = ("X", "Y", "N")
_OFF = {"x": 0.1, "y": 0.1, "psi": 2e-3, "azimuth": 2e-3, "r": 1e-3}  # m, rad, rad/s: connector offsets
_OFF |= dict.fromkeys(("u", "v", "u_r", "v_r"), 0.01)  # m/s
_OFF_DRIVE = 2e-3  # of the largest speed or thrust
_OFF_PARAMETER = 0.1  # of a tolerance
_LEAD = 30.0  # s, in which an FMU settles at what the log begins with
_MOST_STEPS = 250_000  # of all FMUs together
_NEAR = 0.05  # of the largest speed, and in rad: other inputs than these have a law of their own


class Bollard(NamedTuple):
    """Thrust by squared speed, along an axis, at a place.

    Attributes
    ----------
    ahead, astern : float
        0 where the log does not show it. [N/rpm2]
    axis : float
        Direction of the thrust, added to that of a unit that turns. [rad]
    x, y : float
        [m]
    """

    ahead: float = 0.0
    astern: float = 0.0
    axis: float = 0.0
    x: float = 0.0
    y: float = 0.0

    def loads(self, rpm, azimuth):
        """Loads on the ship, and their slopes by speed and direction; three tuples of three. [N, N, N.m]"""
        c, s = np.cos(self.axis + azimuth), np.sin(self.axis + azimuth)
        share = np.where(rpm >= 0.0, self.ahead, self.astern)
        along, across = (c, s, self.x * s - self.y * c), (-s, c, self.x * c + self.y * s)
        thrust, slope = share * rpm * np.abs(rpm), 2.0 * share * np.abs(rpm)
        return tuple(
            tuple(size * arm for arm in arms) for size, arms in ((thrust, along), (slope, along), (thrust, across))
        )


@dataclass(frozen=True, eq=False)
class Surrogate:
    """Loads over a log: the bollard law, and linear in all that deviates what the FMU does otherwise.

    Attributes
    ----------
    time : (k,) array
        Even. [s]
    about : dict of str to (k,) array
        What the FMU was fed with, by quantity. [rpm, N, rad, m, m/s, rad/s]
    nominal : dict of str to float
        Its parameters that have slopes.
    rest : (1 + q + p, 3, k) array
        Load less that of the bollard law, then its slopes by each of `about`, by each of `nominal`.
    bollard : Bollard
    rpm_max : float
        Largest speed, the FMU's or the log's. [rpm]
    """

    time: np.ndarray
    about: dict
    nominal: dict
    rest: np.ndarray
    bollard: Bollard
    rpm_max: float

    def loads(self, time, given, part):
        """Loads on the ship.

        Parameters
        ----------
        time : array
            [s]
        given : dict of str to array
            By quantity, at these times.
        part : BlackBox

        Returns
        -------
        tuple of three arrays
            X, Y, N. [N, N, N.m]
        """
        at = np.clip((time - self.time[0]) / (self.time[1] - self.time[0]), 0.0, self.time.size - 1.0)
        low = np.minimum(np.asarray(at).astype(int), self.time.size - 2)
        share = at - low
        rest = self.rest[..., low] * (1.0 - share) + self.rest[..., low + 1] * share
        given = given | {name: given[name] + sign * getattr(part, off) for name, off, sign in _wrong(given, part)}
        found = list(rest[0])
        off = [given[name] - (v[low] * (1.0 - share) + v[low + 1] * share) for name, v in self.about.items()]
        off += [getattr(part, name) - value for name, value in self.nominal.items()]
        for deviation, slopes in zip(off, rest[1:], strict=True):
            found = [load + slope * deviation for load, slope in zip(found, slopes, strict=True)]
        if "rpm" in self.about:
            ideal = self.bollard.loads(given["rpm"], given["azimuth"])[0]
            found = [load + more for load, more in zip(found, ideal, strict=True)]
        kept = 1.0 - getattr(part, "thrust_loss", 0.0)
        return tuple(kept * load for load in found)

    def fits(self, record, units):
        """Whether it is that of these times and inputs."""
        inside = self.time[0] <= record.time[0] and record.time[-1] <= self.time[-1] + 1e-6
        near = {kind: _NEAR * max(np.abs(self.about.get(kind, 0.0)).max(), 1.0) for kind in ("rpm", "thrust")}
        near["azimuth"] = _NEAR
        return inside and all(
            np.sqrt(np.mean((units[kind] - np.interp(record.time, self.time, values)) ** 2)) < near[kind]
            for kind, values in self.about.items()
            if kind in DRIVES
        )


def _wrong(given, part):
    """What of the inputs may be wrong: quantity, number, sign."""
    wrong = (("rpm", "rpm_offset", -1.0), ("azimuth", "azimuth_offset", 1.0))
    return [one for one in wrong if one[0] in given and hasattr(part, one[1])]


def with_surrogates(model, record, motion):
    """The ship with the law of each of her black boxes over a log.

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
    units = {name: drives_of(*pair) for name, pair in record.units.items()}
    new = {
        name: one
        for name, one in model.third_party.items()
        if one.law is None or not one.law.fits(record, units.get(name, {}))
    }
    laws = surrogates_of(new, record.time, units, motion) if new else {}
    third_party = model.third_party | {name: replace(new[name], law=law) for name, law in laws.items()}
    parts, tolerances = dict(model.parts), dict(model.tolerances)
    for name, one in third_party.items():
        if "rpm" in one.drives:
            parts[name] = replace(parts[name], rpm_max=one.law.rpm_max)
            tolerances[f"{name}.rpm_offset"] = 5e-4 * one.law.rpm_max
    return replace(model, parts=parts, tolerances=tolerances, third_party=third_party)


def surrogates_of(third_party, time, units, motion):
    """Laws of several FMUs, from one co-simulation.

    Parameters
    ----------
    third_party : dict of str to ThirdPartyFmu
    time : (n,) array
        Even. [s]
    units : dict of str to dict of str to (n,) array
        By third-party FMU: what drives it, as `drives_of` gives it.
    motion : Motion
        (n,) arrays, through still water.

    Returns
    -------
    dict of str to Law
    """
    moved = dict(zip(MOTION, (*motion, motion.u, motion.v), strict=True))
    given = {name: moved | units.get(name, {}) for name in third_party}
    runs = [run for name, one in third_party.items() for run in _runs(name, one, given[name])]
    fine = _fine(time, len(runs), max((one.step or 0.0 for one in third_party.values()), default=0.0))
    fed = {name: {q: np.interp(fine, time, values) for q, values in each.items()} for name, each in given.items()}
    table = _simulated(runs, third_party, fed, fine)
    return {
        name: _surrogate(one, [run for run in runs if run.of == name], table, fine, fed[name])
        for name, one in third_party.items()
    }


class _Run(NamedTuple):
    """One copy of an FMU, with one quantity or number off by something."""

    of: str
    name: str
    quantity: str = ""
    number: str = ""
    by: float = 0.0


def _runs(name, one, given):
    """All copies of an FMU: as it is, and with each of its quantities and parameters off."""
    yield _Run(name, name)
    for quantity in dict.fromkeys(link.quantity for link in one.links):
        by = _OFF.get(quantity) or _OFF_DRIVE * max(np.abs(given[quantity]).max(), 1.0)
        yield _Run(name, f"{name} with another {quantity}", quantity, by=by)
    for number, variable in one.parameters.items():
        by = _OFF_PARAMETER * one.component.tolerances[variable]
        yield _Run(name, f"{name} with another {variable}", number=number, by=by)


def _fine(time, runs, step):
    """Times of the run: a quarter of the rows' step or the system's own, coarser where there are many copies."""
    row, span = time[1] - time[0], time[-1] - time[0]
    wanted = max(0.25 * row, step, min(row, runs * span / _MOST_STEPS))
    h = step * max(int(wanted / step + 1e-6), 1) if step else wanted
    return time[0] + h * np.arange(int(np.ceil(span / h - 1e-6)) + 1)


def _simulated(runs, third_party, fed, fine):
    """Table of a co-simulation of all copies, settled beforehand; rows are those of the times and one more."""
    h = fine[1] - fine[0]
    lead, components, connections, inputs, columns = int(np.ceil(_LEAD / h)), {}, [], {}, {}
    for run in runs:
        one = third_party[run.of]
        start = dict(one.component.start)
        if run.number:
            variable = one.parameters[run.number]
            start[variable] = one.component.start_value(variable) + run.by
        components[run.name] = replace(one.component, name=run.name, start=start, step_size=None)
        for link in one.links:
            place = f"{run.of} {link.quantity}"
            off = link.factor * run.by if link.quantity == run.quantity else 0.0
            connections.append(Connection((None, place), (run.name, link.variable), link.factor, link.offset + off))
            inputs[place] = Signal(place, "Real")
            columns[place] = np.concatenate([np.full(lead, fed[run.of][link.quantity][0]), fed[run.of][link.quantity]])
    clock = h * np.arange(lead + fine.size + 1)
    table = make_table(clock, [(name, np.append(values, values[-1]), "", "") for name, values in columns.items()])
    system = System("parts alone", "parts alone", components, tuple(connections), inputs)
    found = simulate(system, Scenario(stop_time=float(clock[-1]), step_size=float(h)), RunOptions(inputs=table))
    return found.isel(time=slice(lead + 1, None))  # what a step makes of a row is there at its end


def _surrogate(one, runs, table, fine, fed):
    """The law of a third-party FMU from the runs of its copies."""
    base, *others = (_on_ship(one, run.name, table) for run in runs)
    quantities = [run.quantity for run in runs if run.quantity]
    nominal = {n: one.component.start_value(v) for n, v in one.parameters.items()}
    rest = np.stack([base, *((other - base) / run.by for other, run in zip(others, runs[1:], strict=True))])
    about, bollard, most = {q: fed[q] for q in quantities}, Bollard(), 1.0
    if "rpm" in about:
        top = next(one.component.fmu.variables[x.variable].maximum for x in one.links if x.quantity == "rpm")
        factor = next(link.factor for link in one.links if link.quantity == "rpm")
        logged = float(max(np.abs(fed["rpm"]).max(), 1.0))
        most = max(abs(top / factor), logged) if top and np.isfinite(top) and top < 1e6 else logged
        bollard = bollard_of(base, fed["rpm"], fed["azimuth"], "azimuth" in about)
        ideal = bollard.loads(fed["rpm"], fed["azimuth"])
        rest[0] -= ideal[0]
        for quantity, slopes in zip(("rpm", "azimuth"), ideal[1:], strict=True):
            if quantity in about:
                rest[1 + quantities.index(quantity)] -= slopes
    return Surrogate(fine, about, nominal, rest, bollard, most)


def _on_ship(one, name, table):
    """Load of a copy on the ship, (3, k) array."""
    found = np.zeros((3, table.sizes["time"]))
    for axis, output, factor, offset in one.loads:
        found[_AXES.index(axis)] += factor * table[f"{name}.{output}"].values + offset
    return found


def bollard_of(load, rpm, azimuth, turns):
    """The bollard law nearest to loads.

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
    Bollard
        Without thrust where the loads do not go with the squared speed.
    """
    square = rpm * np.abs(rpm)
    scale = square @ square
    if scale == 0.0:
        return Bollard()
    axis = 0.0 if turns else float(np.arctan2(load[1] @ square, load[0] @ square))
    along = np.cos(axis + azimuth) * load[0] + np.sin(axis + azimuth) * load[1]
    both = along @ square / scale
    ways = [square * where for where in (rpm > 0.0, rpm < 0.0)]
    ahead, astern = (max(along @ way / (way @ way), 0.0) if way @ way > 0.01 * scale else both for way in ways)
    if both <= 0.0 or min(ahead, astern) <= 0.0:
        return Bollard()
    levers = np.stack([load[1], -load[0]], axis=-1)
    x, y = np.linalg.lstsq(levers, load[2], rcond=1e-6)[0]
    return Bollard(float(ahead), float(astern), axis, float(x), float(y))
