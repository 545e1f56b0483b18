"""Whether a log in an odd form is read right: without a channel file, else with the proposed one, else what is said."""

from __future__ import annotations

import numpy as np

from shipcosim.diagnose.log.channels import ChannelFile
from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of, read_log
from shipcosim.errors import ShipcosimError

TURNS = ("heading", "azimuth", "wind_from")
FINE = {"north": 0.05, "east": 0.05, "time": 2e-3}
"""By how much values may be off, from digits in the file; 2e-3 of the largest else."""


def outcome(path, table, thrusters, lacking=()):
    """``"read"``, ``"proposed"``, ``"said"`` or ``"wrong"``, and what was said or is wrong."""
    wrong = ""
    try:
        log = read_log(path, None, thrusters)
        wrong, missing = compared(log, table, lacking)
        if not wrong and not missing:
            return "read", ""
        said = f"missing {missing}: {log.attrs['column_remarks']}"
    except ShipcosimError as error:
        said = str(error)
    if wrong:
        return "wrong", wrong
    try:
        proposal = propose(columns_of(path), thrusters)
        log = read_log(path, ChannelFile(proposal.channels(guessed=True), proposal.form), thrusters)
        wrong, missing = compared(log, table, lacking)
        if not wrong and not missing:
            return "proposed", said
    except ShipcosimError as error:
        wrong = ""
        said += f" | {error}"
    return ("wrong in the proposal", wrong) if wrong else ("said", said)


def compared(log, table, lacking=()):
    """What of a log is wrong, and the roles that it lacks."""
    log = log.sortby("time")
    time = log["time"].values - log["time"].values[0]
    offsets, missing = (
        [],
        [role for role in table if role != "time" and role not in lacking and role not in log],
    )
    for role, right in table.items():
        values = time if role == "time" else log[role].values if role in log else None
        if values is None:
            continue
        if role in ("north", "east"):
            values, right = values - values[np.isfinite(values)][0], right - right[0]
        wanted = np.interp(
            time, table["time"], np.unwrap(right, period=360.0) if role.endswith(TURNS) else right
        )
        off = values - wanted
        off = np.mod(off + 180.0, 360.0) - 180.0 if role.endswith(TURNS) else off
        known = np.isfinite(off)
        worst = float(np.quantile(np.abs(off[known]), 0.99)) if known.any() else np.inf
        if worst > FINE.get(role, 2e-3 * max(np.abs(right).max(), 0.5)) or known.mean() < 0.9:
            offsets.append(f"{role} off by {worst:.3g}, {known.mean():.0%} known")
    return "; ".join(offsets), missing
