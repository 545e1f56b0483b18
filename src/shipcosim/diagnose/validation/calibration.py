"""The known numbers of a ship where a log would have them, within their tolerances: a set apart from the causes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.diagnose.validation.gain import calibrated
from shipcosim.ssp import parameter, write_ssv

if TYPE_CHECKING:
    from shipcosim.diagnose.inference.fitting import Fit
    from shipcosim.ssp import System


def calibrate(system: System, fit: Fit, path: str | os.PathLike[str]) -> dict[str, float]:
    """Write a parameter set with every known number of a system moved within its tolerance as a log wants it.

    None of this is a cause, and not all of it is true: numbers that the log cannot tell apart share what they explain.
    What named causes turn is left to extended.ssv.

    Parameters
    ----------
    system : System
        That the log was diagnosed with.
    fit : Fit
        To the log.
    path : path
        The .ssv, to be bound to the system or to the extended one.

    Returns
    -------
    dict of str to float
        What the set holds, in the units of the FMUs.

    Raises
    ------
    ShipcosimError
        If it cannot be written.
    """
    moved, before, values = calibrated(fit), fit.model, {}
    deviations = np.sqrt(np.diag(fit.covariance))
    causes = {place for hypothesis in fit.hypotheses for of in hypothesis.parameters for place in of.paths}
    for column, deviation in zip(fit.columns, deviations, strict=True):
        for place, size in column.changes.items():
            variable = _same(system, place, before.get(place))
            if place not in causes and variable is not None:
                unit = None if variable.unit in (None, "1") else variable.unit
                text = f"{variable.description}; within its tolerance as the log wants it, no cause"
                values[place] = parameter(place, float(moved.get(place)), unit, text, tolerance=deviation * size)
    write_ssv(path, "calibrated", values.values())
    return {name: value.value for name, value in values.items()}


def _same(system, place, value):
    """Variable of the system that holds a number of the ship; None where it has none, or another value or unit."""
    component, _, name = place.rpartition(".")
    part = system.components.get(component)
    if part is None or name not in part.fmu.variables:
        return None
    start = part.start_value(name)
    return part.fmu.variables[name] if np.isclose(float(start), value, rtol=1e-9, atol=1e-12) else None
