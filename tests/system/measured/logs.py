"""Measured logs of craft as tables that channel files fit: what is no table becomes one, and nothing else is changed.

The logs lie beside the project in ``shared/measured`` and are no part of it; where they are not, tests skip.
"""

import gzip
from pathlib import Path

import numpy as np
import pandas

CHANNELS = Path(__file__).resolve().parent / "channels"
FOLDERS = {"blueboat": "blueboat_2024", "otter": "otter_2024", "kvlcc2": "kvlcc2_hsva"}
"""Craft: folder of her logs; her system is ``NAME_open``."""
KVLCC2 = "t x y psi u v r roll rudder n thrust torque".split()


def files(shared, craft):
    """Paths of the logs of a craft."""
    folder = shared / "measured" / FOLDERS[craft]
    return sorted(path for path in folder.iterdir() if path.suffix == ".gz")


def as_table(path, folder):
    """Path of a .csv that a channel file fits, in a folder: of a BlueBoat's log the log itself."""
    convert = {"kvlcc2_hsva": _kvlcc2, "otter_2024": _otter}.get(path.parent.name)
    if convert is None:
        return path
    target = folder / f"{path.name.partition('.')[0]}.csv"
    convert(path).to_csv(target, index=False)
    return target


def _kvlcc2(path):
    """Latin-1 text with lines of a head, then twelve columns without names."""
    with gzip.open(path, "rt", encoding="latin-1") as file:
        rows = [line.split() for line in file]
    return pandas.DataFrame(
        [[float(x) for x in row] for row in rows if _is_row(row)], columns=KVLCC2
    )


def _is_row(row):
    try:
        return len(row) == len(KVLCC2) and bool([float(value) for value in row])
    except ValueError:
        return False


def _otter(path):
    """Semicolons, stamps without a name; damaged cells are missing. Speed and course over ground in the body frame."""
    table = pandas.read_csv(path, sep=";", dtype=str)
    stamps = pandas.to_datetime(table.iloc[:, 0], format="%Y-%m-%d_%H:%M:%S:%f", errors="coerce")
    table = table.iloc[:, 1:].apply(pandas.to_numeric, errors="coerce")
    table["time"] = (stamps - pandas.Timestamp(0)).dt.total_seconds()
    drift = np.radians(table["current_course_over_ground"] - table["current_orientation_3"])
    table["surge"], table["sway"] = (
        table["current_speed"] * np.cos(drift),
        table["current_speed"] * np.sin(drift),
    )
    return table
