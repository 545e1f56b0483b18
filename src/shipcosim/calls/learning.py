"""A craft that no file describes: what has to be given of her, and the ship file that her log starts from."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

import numpy as np

from shipcosim.calls.arguments import named
from shipcosim.errors import error_at
from shipcosim.ships.assumed import LoggedThruster, assumed_ship_text
from shipcosim.ships.given import number_in
from shipcosim.ssp import AnyPath


def check_learning(
    learn: bool,
    length: float | str | None,
    *,
    several: bool,
    system: Any,
    reference: Any,
    causes: Any,
) -> None:
    """Raise ShipcosimError if arguments contradict each other."""
    if not learn:
        raise error_at(
            named("length"),
            "nothing is learned.",
            f"It needs {named('learn')}; the length of a ship with a system is in that system.",
        )
    if length is None:
        raise error_at(
            named("learn"),
            "a log does not tell how long the craft is.",
            f'Give {named("length")}, such as "1.2 m".',
        )
    if system is not None or reference is not None:
        other = named("reference" if system is None else "system")
        raise error_at(
            named("learn"), f"with {other}, her numbers are known already.", "Give one of the two."
        )
    if causes is not None:
        raise error_at(
            named("learn"),
            f"with {named('causes')}: causes are sought in a craft that is known already.",
            "Learn her first, then give the system that it leaves.",
        )
    if several:
        raise error_at(
            named("learn"),
            "there are several logs.",
            "`shipcosim calibrate` with --learn learns from several logs.",
        )


def assumed_craft(logs: Sequence[Any], channels: AnyPath | None, length: float | str | None) -> str:
    """Text of the ship file of a craft, from her length and the thrusters that her logs have.

    Parameters
    ----------
    logs : sequence of path or xarray.Dataset
    channels : path, optional
        Channel file.
    length : float or str
        [m]

    Raises
    ------
    ShipcosimError
        A length that cannot be read; logs without a channel of a thruster, or with too few of one.
    """
    from shipcosim.diagnose.log.reader import read_log
    from shipcosim.diagnose.log.roles import THRUSTER_ROLES

    try:
        size = number_in(length, "m")
    except ValueError as error:
        raise error_at(named("length"), f"{error}", 'Write "1.2 m".') from None
    if not isfinite(size) or size <= 0.0:
        raise error_at(named("length"), f"found {length}.", 'It is greater than 0: "1.2 m".')
    # Of each thruster what drives it, and its largest speed in any of the logs.
    drives: dict[str, set[str]] = {}
    largest: dict[str, float] = {}
    for log in logs:
        table = read_log(log, channels)
        for name, column in table.data_vars.items():
            thruster, _, drive = str(name).rpartition("_")
            if not thruster or drive not in THRUSTER_ROLES:
                continue
            drives.setdefault(thruster, set()).add(drive)
            if drive == "rpm":
                speed = np.abs(column.values)
                most = float(np.nanmax(speed, initial=0.0, where=np.isfinite(speed)))
                largest[thruster] = max(most, largest.get(thruster, 0.0))
        if not drives:
            remedy = "Name them NAME_rpm, NAME_azimuth or NAME_thrust, or say in a channel file which they are."
            raise error_at(
                f"{table.encoding.get('source', 'log')}", "has no channel of a thruster.", remedy
            )
    units = [
        LoggedThruster(name, frozenset(has), largest.get(name, 0.0)) for name, has in drives.items()
    ]
    return assumed_ship_text(size, units)
