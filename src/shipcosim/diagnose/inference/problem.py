"""A repaired log made ready: what can be suspected in it, and how noisy it is."""

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of
from shipcosim.diagnose.inference.fitting import IdentificationProblem, fitted, prepared, weighed
from shipcosim.diagnose.inference.noise import first_noise, tuned
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.surrogate import with_surrogates

__all__ = ["prepare", "unidentifiable"]

_GUSTS = 10.0  # times as fast may an unexplained force walk where nobody knows the wind
_MOST_WALK = 3e-5  # m/s2.5: some 400 N on Gunnerus in ten minutes


def prepare(clean, model, catalogue, noise=None):
    """The case of a repaired log: noise tuned beside whatever explains it best at first sight.

    Parameters
    ----------
    clean : xarray.Dataset
    model : ShipModel
    catalogue : dict of str to Cause
    noise : Noise, optional
        Where it is known already.

    Returns
    -------
    IdentificationProblem
    """
    model = replace(model, span=(float(clean["time"][0]), float(clean["time"][-1])))
    model = replace(model, wind_is_true="wind_speed" not in clean and "true_wind_speed" in clean)
    model = replace(model, fixed={n: angle for n, angle in model.fixed.items() if f"{n}_azimuth" not in clean})
    record, length = record_of(clean, model), model.parts["hull"].length
    motion = first_motion(record, model)
    model = with_surrogates(model, record, motion)
    everyone = hypotheses_of(catalogue, model)
    hidden = unidentifiable(everyone, record, clean, model.third_party)
    if record.wind is None:
        model = replace(model, tolerances=model.tolerances | _unknown_wind(everyone))
    wanted = tuple(hypothesis for hypothesis in everyone if hypothesis not in hidden)
    start = first_noise(record, length) if noise is None else noise
    problem = prepared(IdentificationProblem(record, model, wanted, start, motion))
    if noise is not None:
        return problem
    fit = fitted(problem)
    gain, hypothesis, values = weighed(problem, fit)[0]
    if gain > 3.0:
        fit = fitted(problem, (hypothesis,), values)
    most = _MOST_WALK * np.array([1.0, 1.0, 4.0 / length])
    most *= 1.0 if record.wind is not None else _GUSTS
    noise = tuned(start, fit.linear, record, fit.left, most_walk=most)
    return prepared(replace(problem, noise=noise))


def unidentifiable(everyone, record, clean, third_party=()):
    """Suspects that a log without some channels cannot show: of wind and what acts like it, of silent thrusters.

    Parameters
    ----------
    everyone : sequence of Hypothesis
    record : Record
    clean : xarray.Dataset
    third_party : collection of str
        Thrusters that the log is sure to have, whatever drives them.

    Returns
    -------
    list of Hypothesis
    """
    silent = [name for name in record.units if f"{name}_rpm" not in clean and name not in third_party]
    return [s for s in everyone if s.component in silent or (record.wind is None and s.effect.without_wind != "sought")]


def _unknown_wind(everyone):
    """Tolerances of what stands for the wind, where nobody knows it: the typical size of causes allowed for."""
    allowed = [hypothesis for hypothesis in everyone if hypothesis.effect.without_wind == "allowed for"]
    parameters = [parameter for hypothesis in allowed for parameter in hypothesis.parameters]
    return {path: parameter.typical for parameter in parameters for path in parameter.paths}
