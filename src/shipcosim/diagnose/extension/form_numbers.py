"""Estimates of another form for the system's parameters, and the parameter set with them."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.extension.extend import (
    Extension,
    signals_of,
    structure_of,
    written,
)
from shipcosim.diagnose.extension.extended_system import ExtendedSystem, with_extension
from shipcosim.diagnose.finding import ParameterEstimate
from shipcosim.diagnose.inference.fitting import Fit
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.ssp import AnyPath, System, parameter


def form_numbers(fit: Fit, system: System) -> dict[str, ParameterEstimate]:
    """Estimates of a ship's numbers from a log, for the parameters of her system.

    The form has more numbers than FMUs have parameters: smooth functions over place and angle. A set that left them out
    would be half of an answer, so the others are estimated as if these were the model's.

    Parameters
    ----------
    fit : Fit
        Without causes.
    system : System

    Returns
    -------
    dict of str to ParameterEstimate
        By ``place.name``, in the unit of the system.
    """
    carried = np.array([_is_carried(column.changes, system) for column in fit.columns], bool)
    if not carried.any():
        return {}
    # Mean and covariance of what is carried, given that the rest is as in the model: those of a Gaussian.
    to_rest = fit.covariance[np.ix_(carried, ~carried)]
    gain = to_rest @ np.linalg.pinv(fit.covariance[np.ix_(~carried, ~carried)])
    mean = fit.left[carried] - gain @ fit.left[~carried]
    std = np.sqrt(np.diag(fit.covariance[np.ix_(carried, carried)] - gain @ to_rest.T))
    numbers = {}
    columns = [column for column, is_in in zip(fit.columns, carried, strict=True) if is_in]
    for column, share, deviation in zip(columns, mean, std, strict=True):
        for path, size in column.changes.items():
            value = fit.model.within_bounds(path, float(fit.model.get(path) + size * share))
            unit = fit.model.about(path)["unit"]
            numbers[path] = ParameterEstimate(value, float(abs(size) * deviation), unit)
    return numbers


def _is_carried(changes: Mapping[str, float], system: System) -> bool:
    """Whether the system has parameters for all numbers of a column."""
    return all(
        not ShipModel.is_of_day(path)
        and place in system.components
        and name in system.components[place].variables
        for path in changes
        for place, _, name in [path.rpartition(".")]
    )


def with_form_numbers(
    given: ExtendedSystem,
    numbers: Mapping[str, ParameterEstimate],
    log: Identification,
    folder: AnyPath,
) -> ExtendedSystem:
    """A system with the numbers of another form in it.

    Parameters
    ----------
    given : ExtendedSystem
        Not extended yet.
    numbers : mapping of str to ParameterEstimate
        As from `form_numbers`.
    log : Identification
        That they are from.
    folder : path
        Gets extended.ssp and extended.ssv.

    Returns
    -------
    ExtendedSystem
        With a remark where the system cannot be extended.
    """
    return with_extension(given, lambda: _extension(given, numbers, log, folder))


def _extension(given, numbers, log, folder) -> Extension:
    structure = structure_of(given.source)
    name = Path(log.log.encoding.get("source", "log")).name
    values = {}
    for path, of in numbers.items():
        text = f"as {name} would have it, beside the others of this set; {log.ship.get(path):.6g} before"
        unit = None if of.unit == "1" else of.unit
        values[path] = parameter(path, of.estimate, unit, text, tolerance=of.std)
    ssp, ssv = written(structure, values.values(), folder)
    sizes = {path: value.value for path, value in values.items()}
    return Extension(ssp, ssv, sizes, signals=signals_of(log.ship.vessel))
