"""Static capability of a study's ship, drawn next to the study's results if a view asks for it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from shipcosim.capability import capability_of, vessel_of
from shipcosim.capability.conditions import DIRECTIONS
from shipcosim.capability.result import LEVEL_1, SIMULATOR
from shipcosim.errors import ShipcosimError
from shipcosim.sweep.study_model import View

NAMES = {SIMULATOR: "static, simulator's models", LEVEL_1: "static, Level 1"}
DASHES = {SIMULATOR: "dash", LEVEL_1: "dot"}


def static_curves(
    views: Sequence[View],
    system: os.PathLike[str],
    parameters: Sequence[os.PathLike[str]],
) -> tuple[list[dict[str, Any]], list[str]]:
    """Static DP capability numbers around the ship, for the polar views that ask for them.

    Parameters
    ----------
    views : sequence of View
    system : path
    parameters : sequence of path
        Parameter sets, the last of which names the ship.

    Returns
    -------
    (list of dict, list of str)
        Curves as `StudyTables.about` has them under `beside`, and why there are none.
    """
    asking = [view for view in views if view.static]
    if not asking:
        return [], []
    # A ship without the needed data is no error of the study.
    try:
        capability = capability_of(vessel_of(system, parameters))
    except ShipcosimError as error:
        return [], [f"The static capability is not drawn. {error}"]
    # A curve for each case, basis and radius.
    curves = [
        {
            "radius": radius,
            "basis": basis,
            "dash": DASHES[basis],
            "series": case.name,
            "name": f"{case.name}: {NAMES[basis]}",
            "angle": DIRECTIONS.tolist(),
            "radius_values": numbers.tolist(),
        }
        for radius in dict.fromkeys(view.radius for view in asking)
        for basis in NAMES
        for case, numbers in zip(capability.cases, capability.numbers(basis), strict=True)
    ]
    return curves, []
