"""Files of MATLAB as columns: arrays and fields of structs that are as long as most."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from shipcosim.diagnose.log.files.text import head_of
from shipcosim.errors import error_at

READ = """
import pickle, sys, scipy.io
pickle.dump(scipy.io.loadmat(sys.argv[1], simplify_cells=True), sys.stdout.buffer)
"""
"""Program of a process of its own that reads a file: a damaged one may crash scipy, and the process with it."""


def is_matlab(path: Path) -> bool:
    """Whether a file is one of MATLAB by its first bytes."""
    return head_of(path, 10) == b"MATLAB 5.0"


def columns_of_matlab(
    path: Path,
) -> tuple[dict[str, np.ndarray], dict[str, str], tuple[str, ...]]:
    """Values and units by name, and remarks.

    Raises
    ------
    ShipcosimError
        If scipy is missing, or the file cannot be read or has no series.
    """
    try:
        import scipy  # noqa: F401  # the process below needs it
    except ImportError as error:
        remedy = "Install it by `pip install 'shipcosim[matlab]'`, or write a table as .csv."
        raise error_at(str(path), "files of MATLAB need scipy.", remedy) from error
    child = subprocess.run([sys.executable, "-c", READ, path], capture_output=True, check=False)
    if child.returncode:
        remedy = "In MATLAB `writetable(struct2table(S), 'log.csv')` makes a table."
        raise error_at(str(path), "cannot be read: its content is damaged.", remedy)
    content = pickle.loads(child.stdout)
    series_by_name = dict(_series({k: v for k, v in content.items() if not k.startswith("__")}, ""))
    if not series_by_name:
        remedy = "Save arrays: in MATLAB `S = table2struct(T, 'ToScalar', true)`, `save(FILE, '-struct', 'S')`."
        raise error_at(str(path), "holds no series of numbers.", remedy)
    # The series of a log are equally long; what is not is left out.
    length = Counter(map(len, series_by_name.values())).most_common(1)[0][0]
    others = [name for name, values in series_by_name.items() if len(values) != length]
    values = {name: series for name, series in series_by_name.items() if len(series) == length}
    remarks = [f"Series of other lengths left out: {', '.join(others)}."] if others else []
    return values, dict.fromkeys(values, ""), tuple(remarks)


def _series(value: Any, name: str):
    """Names and values of all series of numbers or texts."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _series(part, f"{name}.{key}" if name else key)
    elif isinstance(value, np.ndarray) and value.size > 1 and value.dtype.kind in "fiub":
        # Vectors are columns; of a matrix each column is one.
        if value.ndim == 1:
            yield name, value.astype(float)
        elif value.ndim == 2 and value.shape[0] > value.shape[1]:
            for k in range(value.shape[1]):
                yield f"{name} {k + 1}", value[:, k].astype(float)
    elif isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "UO":
        if all(isinstance(cell, str) for cell in value) and value.size > 1:
            yield name, value.astype(object)
