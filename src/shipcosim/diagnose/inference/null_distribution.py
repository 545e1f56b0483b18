"""What healthy logs like this one score by chance: the ship keeps the log's track under a DP, many times over.

Each of the healthy ships differs from the modelled one within its tolerances and has noise as in the log. Feedback
moves thrusters and weather together, and a ship that keeps still moves by its noise alone: both can look like a cause,
and here nothing is wrong that could be one.
"""

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.inference.evidence import gram
from shipcosim.diagnose.inference.fitting import gains, prepared
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.linearisation import SLOW_STD, SLOW_TIME
from shipcosim.diagnose.inference.noise import waves_of
from shipcosim.diagnose.ship.inputs import Record, first_motion
from shipcosim.diagnose.ship.model import shown
from shipcosim.diagnose.ship.track_keeping import Dp, sailed

__all__ = ["healthy_records", "null_gains"]

_ASTRAY = 10.0  # times the usual squared innovations: of a small craft that spun away, as one in fifty did


def null_gains(case, motion, wanted, *, count=50, seed=0, batch=5):
    """Gain of suspects on healthy logs like this one.

    Parameters
    ----------
    case : Case
    motion : Motion
        The log's track.
    wanted : sequence of Suspect
        Those that are asked for.
    count : int
        Number of healthy ships.
    seed : int
    batch : int
        How many are filtered at once.

    Returns
    -------
    dict of str to (m,) array
        By the suspect's label. [nats] Ships that the linear problem loses tell nothing and are left out.
    """
    records = healthy_records(case, motion, count, np.random.default_rng(seed))
    case = replace(case, suspects=tuple(wanted), known_of=case.suspects)
    missed, found = [], {suspect.label: [] for suspect in wanted}
    for first in range(0, count, batch):
        record = _some(records, slice(first, first + batch))
        here = prepared(replace(case, record=record, motion=first_motion(record, case.plant)), rounds=1)
        columns = case.known(())
        for products in gram(innovations(here.base, case.noise, record)).products:
            missed.append(products[0, 0])
            for gain, suspect, _ in gains(products, columns, np.zeros(len(columns)), wanted, case.plant):
                found[suspect.label].append(gain)
    told = np.array(missed) < _ASTRAY * np.median(missed)
    return {label: np.array(values)[told] for label, values in found.items()}


def _some(records, which):
    """Some of several logs."""
    units = {name: tuple(series[which] for series in pair) for name, pair in records.units.items()}
    return replace(records, measured=records.measured[which], units=units)


def healthy_records(case, motion, count, rng):
    """Logs of healthy ships that keep to a track in the log's weather.

    Parameters
    ----------
    case : Case
    motion : Motion
        The track, (n,) arrays.
    count : int
        Number of ships m.
    rng : numpy.random.Generator

    Returns
    -------
    Record
        With the ships on the first axis.
    """
    plant, record, noise = _drawn(case.plant, count, rng), case.record, case.noise
    jolts = rng.standard_normal((record.time.size, 3, count)) * (np.asarray(noise.jolt) * np.sqrt(record.step))[:, None]
    ships, units = sailed(plant, count, motion, record, Dp(case.plant, record.step), jolts=jolts)
    return _logged(ships, units, plant, case, rng)


def _drawn(plant, count, rng):
    """Ships within the tolerances of a plant."""
    values = {
        path: plant.get(path) + tolerance * rng.standard_normal(count)
        for path, tolerance in plant.tolerances.items()
        if not path.startswith(("instruments.", "water."))
    }
    return plant.with_values(values)


def _logged(motion, units, plant, case, rng):
    """The log of the ships' motion, with the noise of the case: white, of waves, and slow in position and heading."""
    record, (count, n) = case.record, motion.x.shape
    measured = np.stack([value.T for value in shown(motion, case.plant)], axis=-1)  # (n, m, 6)
    measured += rng.standard_normal(measured.shape) * np.asarray(case.noise.white)
    measured += _shown_waves(waves_of(case.noise, record.step, (n, count), rng), motion.psi.T)
    keep = np.exp(-record.step / SLOW_TIME)
    slow = SLOW_STD * rng.standard_normal((count, 3))
    for k in range(n):
        measured[k, :, :3] += slow
        slow = keep * slow + np.sqrt(1.0 - keep**2) * SLOW_STD * rng.standard_normal((count, 3))
    measured = np.where(np.isfinite(record.measured)[:, None, :], measured, np.nan)
    return Record(record.time, np.moveaxis(measured, 1, 0), units, record.wind, record.known)


def _shown_waves(waves, psi):
    """Waves' place and velocity in the ship's axes as the channels show them, all (n, m, 6)."""
    x, y, *others = np.moveaxis(waves, -1, 0)
    return np.stack([np.cos(psi) * x - np.sin(psi) * y, np.sin(psi) * x + np.cos(psi) * y, *others], axis=-1)
