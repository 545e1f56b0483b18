"""Another form of the ship's loads, as far as the system has parameters for it."""

from collections.abc import Mapping

import numpy as np

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.inference.fitting import Fit
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.ssp import System


def craft_of_form(fit: Fit, system: System) -> LearnedCraft:
    """The craft with those of a fit's numbers that her system has parameters for.

    The form has more numbers than FMUs have parameters: smooth functions over place and angle. A set that left them out
    would be half of an answer, so the others are estimated as if these were the model's.

    Parameters
    ----------
    fit : Fit
        Without causes.
    system : System

    Returns
    -------
    LearnedCraft
        Without a number where the system has parameters for none.
    """
    carried = np.array([_is_carried(column.changes, system) for column in fit.columns], bool)
    # Mean and covariance of what is carried, given that the rest is as in the model: those of a Gaussian.
    to_rest = fit.covariance[np.ix_(carried, ~carried)]
    gain = to_rest @ np.linalg.pinv(fit.covariance[np.ix_(~carried, ~carried)])
    mean = fit.left[carried] - gain @ fit.left[~carried]
    std = np.sqrt(np.diag(fit.covariance[np.ix_(carried, carried)] - gain @ to_rest.T))
    before = {}
    after = {}
    stds = {}
    columns = [column for column, is_in in zip(fit.columns, carried, strict=True) if is_in]
    for column, share, deviation in zip(columns, mean, std, strict=True):
        for path, size in column.changes.items():
            before[path] = float(fit.model.get(path))
            after[path] = fit.model.within_bounds(path, before[path] + float(size * share))
            stds[path] = float(abs(size) * deviation)
    return LearnedCraft((), before, after, stds)


def _is_carried(changes: Mapping[str, float], system: System) -> bool:
    """Whether the system has parameters for all numbers of a column."""
    return all(
        not ShipModel.is_of_day(path)
        and place in system.components
        and name in system.components[place].variables
        for path in changes
        for place, _, name in [path.rpartition(".")]
    )
