"""Sobol indices: how much of a quantity's variance each sampled parameter accounts for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.sweep.plan import Plan
from shipcosim.sweep.sampling import salib_problem
from shipcosim.sweep.summary import CONFIDENCE, by_levels

if TYPE_CHECKING:
    import pandas

RESAMPLES = 1000
"""Of the bootstrap."""
FEWEST = 4
"""Blocks of the design from which indices are estimated at all."""


def has_indices(plan: Plan) -> bool:
    """True if the samples of a plan are for Sobol indices."""
    sample = plan.study.sample
    return plan.samples is not None and sample is not None and sample.method == "saltelli"


def indices_of(plan: Plan, runs: pandas.DataFrame) -> tuple[pandas.DataFrame, list[str]]:
    """Sobol indices of each quantity for each sampled parameter, the largest first.

    A failed run, or one in which the quantity has no value, takes its block with it: without one of its runs the
    others of a block say nothing.

    Parameters
    ----------
    plan : Plan
        Sampled by `saltelli`.
    runs : DataFrame
        The table of runs, as far as they are done.

    Returns
    -------
    DataFrame
        Levels of the other factors, `quantity`, `parameter`, `first_order` and `total` each with ``_low`` and
        ``_high`` of the 95 % interval by the bootstrap, `blocks` of the design that it was estimated from. [1]
    list of str
        What was left out.

    References
    ----------
    Saltelli et al., Variance based sensitivity analysis of model output, Comput. Phys. Commun. 181, 2010.
    """
    import pandas

    columns = [column.name for column in plan.samples.columns] if plan.samples else []
    factors = [factor.name for factor in plan.study.factor]
    rows = []
    remarks = []
    # The indices hold for one combination of the other factors at a time.
    for levels, part in by_levels(runs, factors):
        for measure in plan.measures:
            # Saltelli's design: blocks of (parameters + 2) samples. An index needs the whole block.
            values = np.full(plan.shape[-1], np.nan)
            sound = part[part["error"] == ""]
            values[sound["sample"].to_numpy(int)] = sound[measure.name].to_numpy(float)
            blocks = values.reshape(-1, len(columns) + 2)
            is_complete = np.asarray(np.isfinite(blocks).all(axis=1))
            # Report how many blocks are lost, and why: failed runs or runs not done yet.
            if not is_complete.all():
                # A sentence on blocks that are not used.
                done = np.isin(np.arange(plan.shape[-1]), part["sample"]).reshape(blocks.shape)
                open_ = int((~done.all(axis=1)).sum())
                bad = int((~is_complete).sum()) - open_
                why = [f"{bad} since a run of it failed or has no value"] if bad else []
                why += [f"{open_} since not all of it is done"] if open_ else []
                unknown = int((~is_complete).sum())
                missing = (
                    f"indices without {unknown} of {len(is_complete)} blocks, {', '.join(why)}."
                )
                remarks.append(f"{_of(measure.name, levels)}: {missing}")
            # Without variance, or with very few blocks, an index would be noise.
            if is_complete.sum() >= FEWEST and np.ptp(blocks[is_complete]) > 0.0:
                rows += _rows(levels, measure.name, columns, blocks[is_complete], plan.study.seed)
            else:
                remarks.append(
                    f"{_of(measure.name, levels)}: no indices, it is the same in all runs, or too few are done."
                )
    head = [*factors, "quantity", "parameter", "first_order", "first_order_low", "first_order_high"]
    return pandas.DataFrame(
        rows, columns=[*head, "total", "total_low", "total_high", "blocks"]
    ), remarks


def _rows(
    levels: dict, quantity: str, columns: Sequence[str], blocks: np.ndarray, seed: int
) -> list[dict[str, Any]]:
    """Rows of a quantity, the largest total index first."""
    # First order: the variance that the parameter explains alone. Total: with all its interactions.
    # The interval is a bootstrap over the blocks.
    from SALib.analyze import sobol

    indices = sobol.analyze(
        salib_problem(len(columns)),
        blocks.ravel(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=seed + 1,  # SALib takes 0 for none
    )
    rows = []
    for k in np.argsort(-indices["ST"], kind="stable"):
        row = levels | {"quantity": quantity, "parameter": columns[k]}
        # SALib gives half the width of the interval.
        for name, short in (("first_order", "S1"), ("total", "ST")):
            value = float(indices[short][k])
            half = float(indices[f"{short}_conf"][k])
            row |= {name: value, f"{name}_low": value - half, f"{name}_high": value + half}
        rows.append(row | {"blocks": len(blocks)})
    return rows


def _of(quantity: str, levels: dict[str, Any]) -> str:
    return ", ".join([quantity, *(f"{name} {level}" for name, level in levels.items())])
