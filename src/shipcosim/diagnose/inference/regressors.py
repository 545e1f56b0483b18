"""Regressors by which a hypothesis is first sought in a log."""

from collections.abc import Iterable

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.linearisation import Regressor

DIRECTIONS = 12
"""Directions in which a vector is sought, evenly over the circle."""


def regressors_of(hypotheses: Iterable[Hypothesis]) -> list[Regressor]:
    """All regressors for the first search over several hypotheses."""
    return [
        column
        for hypothesis in hypotheses
        for group in screening_regressors(hypothesis)
        for column in group
    ]


def placed(
    hypotheses: Iterable[Hypothesis], first: int
) -> list[tuple[Hypothesis, list[Regressor], list[int]]]:
    """Each group of `regressors_of`, with its hypothesis and its places in a row of columns from `first` on."""
    groups = []
    for hypothesis in hypotheses:
        for group in screening_regressors(hypothesis):
            groups.append((hypothesis, group, list(range(first, first + len(group)))))
            first += len(group)
    return groups


def screening_regressors(hypothesis: Hypothesis) -> list[list[Regressor]]:
    """Groups of regressors by which a hypothesis is first sought: one, or one for each direction of a vector."""
    parameters = hypothesis.parameters
    # All parameters of a linear law enter at once.
    if hypothesis.definition.law == "linear":
        return [
            [
                Regressor(dict.fromkeys(parameter.paths, parameter.typical))
                for parameter in parameters
            ]
        ]
    # A vector that turns is linear in its start and its growth.
    if hypothesis.definition.law == "turning":
        return [
            [Regressor({path: parameters[0].typical}) for path in hypothesis.definition.sought_by]
        ]
    # A constant vector: size and direction are not linear, so directions are tried one by one.
    pair = (parameters[0].path, parameters[1].path)
    size = parameters[0].typical
    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return [
        [Regressor(dict(zip(pair, (size * np.cos(a), size * np.sin(a)), strict=True)))]
        for a in angles
    ]
