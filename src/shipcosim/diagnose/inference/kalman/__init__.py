"""Kalman filter and smoother over the rows of a log. They are recursive, hence in C: kalman.c, compiled by compile.py.

What the filter weighs measurements by depends on the problem and its noise alone, not on the columns that are filtered:
it is computed by itself, and serves any number of columns, now or later. Rows come first in all arrays, then logs; an
array that is the same for all logs has one. All are of doubles, or bools, without gaps.
"""

import ctypes
import functools
import platform
import sys
from pathlib import Path

import numpy as np

from shipcosim.errors import error_at

__all__ = ["log_likelihoods", "smoothed", "weights", "whitened"]

FOLDER = Path(__file__).parent
SUFFIXES = {"linux": ".so", "win32": ".dll", "darwin": ".dylib"}
MACHINES = {"amd64": "x86_64", "aarch64": "arm64"}


def library_for(platform: str) -> Path:
    """The compiled filter of a platform, named as Python does: ``"linux-x86_64"``."""
    return FOLDER / f"{platform}{SUFFIXES.get(platform.split('-')[0], '.so')}"


@functools.cache
def library() -> ctypes.CDLL:
    """The compiled filter of this platform.

    Raises
    ------
    ShipcosimError
        If there is none for it.
    """
    # Processor names differ between operating systems for the same architecture.
    machine = platform.machine().lower()
    file = library_for(f"{sys.platform}-{MACHINES.get(machine, machine)}")
    try:
        return ctypes.CDLL(str(file))
    except OSError as error:
        there = sorted(file.stem for end in SUFFIXES.values() for file in FOLDER.glob(f"*{end}"))
        remedy = f"There are filters for {', '.join(there)}; compile.py beside them makes others."
        raise error_at(
            str(file), f"The diagnosis cannot load its filter: {error}.", remedy
        ) from error


def _call(name: str, sizes: tuple[int, ...], *arrays: np.ndarray | None) -> None:
    """Call a function of the filter with sizes, then arrays; None stands for one that is not wanted."""
    # The compiled code takes plain pointers: refuse arrays of another type or layout.
    pointers = []
    for array in arrays:
        if array is None:
            pointers.append(None)
            continue
        if not array.flags.c_contiguous or array.dtype not in (np.float64, np.bool_):
            raise ValueError(f"{name} takes arrays of doubles or bools without gaps")
        pointers.append(ctypes.c_void_p(array.ctypes.data))
    # A result other than 0 means that it could not allocate memory.
    if getattr(library(), name)(*map(ctypes.c_int64, sizes), *pointers):
        raise MemoryError(name)


def weights(
    A: np.ndarray,
    W: np.ndarray,
    H: np.ndarray,
    R: np.ndarray,
    Q: np.ndarray,
    C: np.ndarray,
    with_value: np.ndarray,
    lost: np.ndarray,
    is_last: np.ndarray,
    begun: np.ndarray,
    keep: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Gains of the filter over some rows.

    Parameters
    ----------
    A : (k, m or 1, a, a) array
        Transition of the first a states of m logs, to the row after each of the first k; k is n, or n - 1 at the end.
    W : (m, s, s) array
        What of it does not change from row to row, added to A.
    H : (n, m or 1, o, s) array
    R : (n, m, o) array
        Variance of the outputs; infinite where there is none.
    Q : (m, s, s) array
        Covariance that a step adds.
    C : (m, s, s) array
        Covariance of the first state before its measurement. Changed: into that of the row after the last one.
    with_value : (k,) bool array
        Whether what drives the ship over the step that follows is known; where not, `lost` is added too.
    lost : (s, s) array
    is_last : (n,) bool array
        Whether a row is the last of a stretch: the next one begins as the first did, with the covariance of `begun`.
    begun : (m, s, s) array
    keep : bool
        Whether the covariances are wanted.

    Returns
    -------
    tuple of arrays
        What a white innovation adds to the state (n, m, o, s), what turns an innovation into a white one (n, m, o, o),
        logarithms of the determinants of their covariance (n, m), covariances of the state after each row's measurement
        (n, m, s, s), empty unless wanted.
    """
    n, m, o = R.shape
    s = W.shape[-1]
    gain = np.empty((n, m, o, s))
    root = np.empty((n, m, o, o))
    logdet = np.empty((n, m))
    covariances = np.empty((n if keep else 0, m, s, s))
    sizes = n, m, o, s, A.shape[-1], len(A), A.shape[1], H.shape[1]
    results = gain, root, logdet, covariances if keep else None
    _call("weights", sizes, A, W, H, R, Q, C, with_value, lost, is_last, begun, *results)
    return gain, root, logdet, covariances


def whitened(
    A: np.ndarray,
    W: np.ndarray,
    B: np.ndarray,
    H: np.ndarray,
    Z: np.ndarray,
    gain: np.ndarray,
    root: np.ndarray,
    is_last: np.ndarray,
    x: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Whitened innovations of every column over some rows, and the state of the first.

    Parameters
    ----------
    A, W, H
        As for `weights`.
    B : (k, m or 1, b, c) array
        What moves the first b states besides, of c columns.
    Z : (n, m or 1, o, c) array
        Outputs.
    gain, root
        As `weights` gives them.
    is_last
        As for `weights`; the next row begins without a deviation.
    x : (m, s, c) array
        State at the first row before its measurement. Changed: into that of the row after the last one.

    Returns
    -------
    tuple of (n, m, o, c) array, (n, m, s) array
        White innovations; state of the first column after each row's measurement.
    """
    (n, _, o, c) = Z.shape
    (m, s) = (gain.shape[1], W.shape[-1])
    white = np.empty((n, m, o, c))
    states = np.empty((n, m, s))
    sizes = (
        n,
        m,
        o,
        s,
        A.shape[-1],
        B.shape[2],
        c,
        len(A),
        A.shape[1],
        B.shape[1],
        H.shape[1],
        Z.shape[1],
    )
    _call("whitened", sizes, A, W, B, H, Z, gain, root, is_last, x, white, states)
    return white, states


def smoothed(
    A: np.ndarray,
    W: np.ndarray,
    H: np.ndarray,
    white: np.ndarray,
    gain: np.ndarray,
    root: np.ndarray,
    states: np.ndarray,
    covariances: np.ndarray,
    is_last: np.ndarray,
    pull: np.ndarray,
) -> np.ndarray:
    """Smoothed state of one column over some rows, by the adjoint form of Bryson and Frazier (1963).

    No matrix is inverted.

    Parameters
    ----------
    A, W, H
        As for `weights`.
    white : (n, m, o) array
    gain, root, states, covariances
        As `weights` and `whitened` give them.
    is_last
        As for `weights`.
    pull : (m, s) array
        Of what is measured after these rows on the state of the row after the last; 0 at the end of a log. Changed:
        into that on the state of the first row.

    Returns
    -------
    (n, m, s) array
    """
    n, m, s = states.shape
    states_out = np.empty((n, m, s))
    sizes = n, m, white.shape[2], s, A.shape[-1], len(A), A.shape[1], H.shape[1]
    _call(
        "smoothed",
        sizes,
        A,
        W,
        H,
        white,
        gain,
        root,
        states,
        covariances,
        is_last,
        pull,
        states_out,
    )
    return states_out


def log_likelihoods(
    A: np.ndarray,
    W: np.ndarray,
    b: np.ndarray,
    H: np.ndarray,
    z: np.ndarray,
    whole: np.ndarray,
    R: np.ndarray,
    Q: np.ndarray,
    P: np.ndarray,
    with_value: np.ndarray,
    lost: np.ndarray,
    is_last: np.ndarray,
) -> np.ndarray:
    """Log-likelihood of one log under several noises, side by side, up to a constant.

    Outputs are taken one after the other, which comes to the same: no matrix is inverted.

    Parameters
    ----------
    A : (n-1, a, a) array
        Transition of the first a states.
    W : (s, s, m) array
        What of it does not change from row to row, added to A.
    b : (n-1, r) array
        What moves the first states besides.
    H : (n, o, s) array
    z : (n, o) array
    whole : (n, o) bool array
        Where there is an output.
    R : (o, m) array
        Variance of the outputs.
    Q, P : (s, s, m) array
    known, lost, is_last
        As for `weights`.

    Returns
    -------
    (m,) array
    """
    (n, o, s) = H.shape
    m = R.shape[1]
    likelihoods = np.empty(m)
    _call(
        "log_likelihoods",
        (n, m, o, s, A.shape[-1], b.shape[1]),
        A,
        W,
        b,
        H,
        z,
        whole,
        R,
        Q,
        P,
        with_value,
        lost,
        is_last,
        likelihoods,
    )
    return likelihoods
