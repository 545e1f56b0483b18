"""A repaired log made ready: what can be suspected in it, and how noisy it is."""

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import suspects
from shipcosim.diagnose.inference.fitting import Case, fitted, prepared, weighed
from shipcosim.diagnose.inference.noise import first_noise, tuned
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.surrogate import lawful

__all__ = ["prepare", "unidentifiable"]

_LIKE_WIND = ("wind_scale", "wind_direction", "wave_drift", "tow")  # steady forces, from the earth or the air
_GUSTS = 10.0  # times as fast may an unexplained force walk where nobody knows the wind
_MOST_WALK = 3e-5  # m/s2.5: some 400 N on Gunnerus in ten minutes


def prepare(clean, plant, catalogue, noise=None):
    """The case of a repaired log: noise tuned beside whatever explains it best at first sight.

    Parameters
    ----------
    clean : xarray.Dataset
    plant : Plant
    catalogue : dict of str to Effect
    noise : Noise, optional
        Where it is known already.

    Returns
    -------
    Case
    """
    plant = replace(plant, span=(float(clean["time"][0]), float(clean["time"][-1])))
    plant = replace(plant, wind_is_true="wind_speed" not in clean and "true_wind_speed" in clean)
    plant = replace(plant, fixed={n: angle for n, angle in plant.fixed.items() if f"{n}_azimuth" not in clean})
    record, length = record_of(clean, plant), plant.parts["hull"].length
    motion = first_motion(record, plant)
    plant = lawful(plant, record, motion)
    everyone = suspects(catalogue, plant)
    hidden = unidentifiable(everyone, record, clean, plant.strangers)
    if record.wind is None:
        plant = replace(plant, tolerances=plant.tolerances | _unknown_wind(everyone))
    wanted = tuple(suspect for suspect in everyone if suspect not in hidden)
    start = first_noise(record, length) if noise is None else noise
    case = prepared(Case(record, plant, wanted, start, motion))
    if noise is not None:
        return case
    fit = fitted(case)
    gain, suspect, values = weighed(case, fit)[0]
    if gain > 3.0:
        fit = fitted(case, (suspect,), values)
    most = _MOST_WALK * np.array([1.0, 1.0, 4.0 / length])
    most *= 1.0 if record.wind is not None else _GUSTS
    noise = tuned(start, fit.linear, record, fit.left, most_walk=most)
    return prepared(replace(case, noise=noise))


def unidentifiable(everyone, record, clean, strangers=()):
    """Suspects that a log without some channels cannot show: of wind and what acts like it, of silent thrusters.

    Parameters
    ----------
    everyone : sequence of Suspect
    record : Record
    clean : xarray.Dataset
    strangers : collection of str
        Thrusters that the log is sure to have, whatever drives them.

    Returns
    -------
    list of Suspect
    """
    silent = [name for name in record.units if f"{name}_rpm" not in clean and name not in strangers]
    return [s for s in everyone if s.component in silent or (record.wind is None and s.cause in _LIKE_WIND)]


def _unknown_wind(everyone):
    """Tolerance of a force over ground, where nobody knows the wind."""
    knobs = [knob for suspect in everyone if suspect.cause == "tow" for knob in suspect.knobs]
    return {path: knob.typical for knob in knobs for path in knob.paths}
