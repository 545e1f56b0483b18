"""Key figures of a run."""

from collections.abc import Sequence

import numpy as np
from xarray import Dataset

from shipcosim.report.run.derived import ERRORS, FROM_REFERENCE
from shipcosim.report.run.predictions import PredictionSummary, texts
from shipcosim.report.run.roles import Roles
from shipcosim.report.theme.views import Table


def key_figures(
    shown: Dataset, roles: Roles, predictions: Sequence[PredictionSummary] = ()
) -> Table:
    """Errors, power, share of time at a limit, prediction errors: numbers to compare runs by.

    Parameters
    ----------
    shown : xarray.Dataset
        Table in the page's units, with the derived signals.
    roles : Roles
        What the signals stand for.
    predictions : sequence of PredictionSummary
        How far off the run's predictions are.

    Returns
    -------
    Table
        Name and text of each.
    """
    figures: list[tuple[str, str]] = []
    # Errors as rms and largest value.
    for name, title in {FROM_REFERENCE: "Position error", ERRORS["psi"]: "Heading error"}.items():
        if name in shown:
            size = np.abs(shown[name].values)
            unit = shown[name].attrs["units"]
            rms = np.sqrt(np.nanmean(size**2))
            largest = np.nanmax(size)
            figures.append((title, f"{rms:.2f} {unit} rms, {largest:.2f} {unit} at most"))
    # Power of all thrusters together: their peaks need not coincide.
    powers = [p for p in (roles.signal(unit, "power") for unit in roles.thrusters) if p in shown]
    if powers:
        total = np.sum([shown[p].values for p in powers], axis=0)
        unit = shown[powers[0]].attrs["units"]
        figures.append(
            (
                "Shaft power",
                f"{np.nanmean(total):.4g} {unit} mean, {np.nanmax(total):.4g} {unit} at most",
            )
        )
    # Share of time at a limit, by component.
    for component, name in roles.flagged("saturated").items():
        if name in shown:
            figures.append(
                (
                    f"At a limit, {component}",
                    f"{100 * np.mean(shown[name].values):.0f} % of the time",
                )
            )
    figures += [(f"Predicted by {what}", ", ".join(words)) for what, *words in texts(predictions)]
    return Table(figures)
