"""Which causes a log with these channels and this motion could tell apart, whatever is wrong.

Each cause in turn is the truth, at its typical size; the known numbers may be off within their tolerances. Another cause
explains a part of what it does to the log. What remains is the log-evidence by which the two differ. As in structured
fault isolation (Gertler, Fault Detection and Diagnosis in Engineering Systems, Dekker, 1998), with noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.experiment.testability import Excitation, expected_gain
from shipcosim.diagnose.inference.thresholds import APART


@dataclass(frozen=True)
class Isolability:
    """Evidence on a cause that a log could give.

    Attributes
    ----------
    label : str
        ``thrust_loss of port``.
    gain : float
        Log-evidence that it would gain at its typical size. [nats]
    is_seen : bool
        Whether that is enough to be named.
    similar : tuple of str
        Of one that is seen: causes that explain it so well that the two could not be told apart, the likest first.
    """

    label: str
    gain: float
    is_seen: bool
    similar: tuple[str, ...]


def isolability(excitation: Excitation) -> tuple[Isolability, ...]:
    """Which causes an excitation could tell apart.

    Parameters
    ----------
    excitation : Excitation

    Returns
    -------
    tuple of Isolability
    """
    # Information on all columns, the log's own residual left out.
    information = excitation.products[1:, 1:]
    # Laws that turn over time are left out: the steady ones stand for them.
    groups = [group for group in excitation.groups if group[0].definition.law != "turning"]
    ours = {place for _, places in excitation.groups for place in places}
    best: dict[str, Isolability] = {}
    for cause, places in groups:
        # Known numbers are free within their tolerances, except those that the cause itself stands for.
        taken = {path for place in places for path in excitation.columns[place].changes}
        of_ship = [
            place
            for place, column in enumerate(excitation.columns)
            if place not in ours and column.prior > 0.0 and not column.gives_way(taken)
        ]
        left = _without(
            information, of_ship, [excitation.columns[place].prior for place in of_ship]
        )
        # Of a vector that direction counts which shows most.
        shown = max(places, key=lambda place: left[place, place])
        gain = 0.5 * left[shown, shown]
        # Of one cause in several directions the nearest counts.
        similar: dict[str, float] = {}
        for other, others in groups:
            if other.label != cause.label:
                remaining = 0.5 * _unexplained(left, shown, others)
                if remaining < min(APART, gain):
                    similar[other.label] = min(remaining, similar.get(other.label, np.inf))
        # A cause that does not show cannot be told from others either.
        is_seen = expected_gain(2.0 * gain) >= excitation.least
        names = tuple(sorted(similar, key=similar.__getitem__)) if is_seen else ()
        isolable = Isolability(cause.label, float(gain), is_seen, names)
        # A cause that is sought in several directions: the one that shows least stands for it.
        if cause.label not in best or gain < best[cause.label].gain:
            best[cause.label] = isolable
    return tuple(best.values())


def _without(information, of_ship, priors):
    """Information on all columns while known numbers may be off: the Schur complement of theirs."""
    among = information[np.ix_(of_ship, of_ship)] + np.diag(1.0 / np.square(priors))
    across = information[of_ship]
    return information - across.T @ np.linalg.solve(among, across)


def _unexplained(information, place, others):
    """Information on one column that is left beside the others, for any size."""
    among = information[np.ix_(others, others)]
    across = information[others, place]
    explained = across @ np.linalg.lstsq(among, across, rcond=1e-9)[0]
    return max(float(information[place, place] - explained), 0.0)
