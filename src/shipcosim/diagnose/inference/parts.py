"""A linear problem by parts of its rows: of a long log only one part at a time is in memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.inference.linearisation import Linear, Regressor, linearise
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.motion import Motion

PART = 4096
"""Most rows of a part: as many as a processor's cache holds series of. A log of an hour at 1 Hz is one part."""
_ENTRIES = 4096 * 64
_LEAST = 512
"""Rows times columns of a part, some 50 MB in all that the filter needs for them; rows that it has at least."""
_KEPT = 600_000
"""Rows times columns that are kept for a second look, 58 MB: those of a fit to a long log's 6000 rows. More are made
anew, which takes half as long again."""

Columns = Callable[[slice], tuple[np.ndarray, np.ndarray]]
"""Further columns of some rows, `driven` and `seen` as in `Linear`."""


@dataclass(frozen=True)
class InParts:
    """A linear problem whose rows are made when they are asked for.

    Attributes
    ----------
    rows : int
    columns : int
        Without the first.
    part : callable
        From a slice of rows, of which start and stop are given, to their `Linear`: with the step to the row after the
        last one, where there is one.
    """

    rows: int
    columns: int
    part: Callable[[slice], Linear]

    def slices(self) -> Iterator[slice]:
        """Rows of each part, in order."""
        # As many rows as memory allows for this number of columns.
        size = min(max(_ENTRIES // (1 + self.columns), _LEAST), PART)
        for first in range(0, self.rows, size):
            yield slice(first, min(first + size, self.rows))

    def whole(self) -> Linear:
        """All rows in one, for problems of few columns."""
        made = list(map(self.part, self.slices()))
        return made[0] if len(made) == 1 else Linear(*map(np.concatenate, zip(*made, strict=True)))

    def chosen(self, columns: Sequence[int]) -> InParts:
        """The problem with only some of its columns, by number from 1 on, besides the first."""
        wanted = [0, *columns]

        def part(rows):
            linear = self.part(rows)
            return linear._replace(driven=linear.driven[..., wanted], seen=linear.seen[..., wanted])

        return InParts(self.rows, len(columns), part)


def in_parts(linear: Linear | InParts) -> InParts:
    """A problem by parts of its rows, however it is given."""
    if isinstance(linear, InParts):
        return linear
    steps = len(linear.seen) - 1

    def part(rows):
        until = slice(rows.start, min(rows.stop, steps))
        return Linear(
            linear.transition[until],
            linear.driven[until],
            linear.output[rows],
            linear.seen[rows],
            linear.whole[rows],
        )

    return InParts(len(linear.seen), linear.seen.shape[-1] - 1, part)


def linearised_by_parts(
    motion: Motion,
    record: Record,
    model: ShipModel,
    regressors: Sequence[Regressor],
) -> InParts:
    """The linear problem about a motion, by parts.

    Parameters
    ----------
    motion : Motion
        (..., n) arrays near what was measured.
    record : Record
    model : ShipModel
    regressors : sequence of Regressor

    Returns
    -------
    InParts
    """
    # A long log is linearised again at every pass, a short one only at the first.
    rows = record.time.size
    columns = len(regressors)
    done = []
    anew = InParts(rows, columns, lambda which: linearise(motion, record, model, regressors, which))
    if rows * (1 + columns) > _KEPT:
        return anew

    def part(which):
        if not done:
            done.append(in_parts(anew.whole()))
        return done[0].part(which)

    return InParts(rows, columns, part)


def with_columns(linear: Linear | InParts, count: int, more: Columns) -> InParts:
    """The problem with further columns behind its own."""
    first = in_parts(linear)

    def part(rows):
        mine = first.part(rows)
        (driven, seen) = more(rows)
        return mine._replace(
            driven=np.concatenate([mine.driven, driven], axis=-1),
            seen=np.concatenate([mine.seen, seen], axis=-1),
        )

    return InParts(first.rows, first.columns + count, part)


def beside(linear: Linear | InParts, extra: Linear | InParts) -> InParts:
    """A problem with the columns of another behind its own."""
    other = in_parts(extra)

    def columns(rows):
        theirs = other.part(rows)
        return theirs.driven[..., 1:], theirs.seen[..., 1:]

    return with_columns(linear, other.columns, columns)


def explained(linear: Linear | InParts, theta: np.ndarray) -> InParts:
    """The problem with only its first column, from which the effect of θ is taken out."""
    # Residual problem y - G θ: first column less the weighted others.
    weights = np.concatenate([[1.0], -np.asarray(theta)])[:, None]
    whole = in_parts(linear)

    def part(rows):
        of_part = whole.part(rows)
        return of_part._replace(driven=of_part.driven @ weights, seen=of_part.seen @ weights)

    return InParts(whole.rows, 0, part)
