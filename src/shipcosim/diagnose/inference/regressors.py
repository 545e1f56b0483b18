"""Regressors by which a hypothesis is first sought in a log."""

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.linearisation import Regressor

DIRECTIONS = 12
"""Directions in which a vector is sought, evenly over the circle."""


def screening_regressors(hypothesis: Hypothesis) -> list[list[Regressor]]:
    """Groups of regressors by which a hypothesis is first sought: one, or one for each direction of a vector."""
    parameters = hypothesis.parameters
    if hypothesis.definition.law == "linear":
        return [
            [
                Regressor(dict.fromkeys(parameter.paths, parameter.typical))
                for parameter in parameters
            ]
        ]
    if hypothesis.definition.law == "turning":
        return [
            [Regressor({path: parameters[0].typical}) for path in hypothesis.definition.sought_by]
        ]
    pair = (parameters[0].paths[0], parameters[1].paths[0])
    size = parameters[0].typical
    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return [
        [Regressor(dict(zip(pair, (size * np.cos(a), size * np.sin(a)), strict=True)))]
        for a in angles
    ]
