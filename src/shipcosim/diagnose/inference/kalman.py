"""Kalman filter and smoother over the rows of a log. They are recursive, hence compiled with numba.

What the filter weighs measurements by depends on the problem and its noise alone, not on the columns that are filtered:
it is computed by itself, and serves any number of columns, now or later. Rows come first in all arrays, then logs; an
array that is the same for all logs has one.
"""

import numpy as np
from numba import njit

__all__ = ["log_likelihoods", "smoothed", "weights", "whitened"]

_compiled = njit(cache=True, nogil=True, error_model="numpy")


@_compiled
def weights(
    A: np.ndarray,
    W: np.ndarray,
    H: np.ndarray,
    R: np.ndarray,
    Q: np.ndarray,
    C: np.ndarray,
    known: np.ndarray,
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
    known : (k,) bool array
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
    gain, root, logdet = np.zeros((n, m, o, s)), np.zeros((n, m, o, o)), np.empty((n, m))
    covariances = np.empty((n if keep else 0, m, s, s))
    HC, S, T, Tt = np.empty((o, s)), np.empty((o, o)), np.empty((s, s)), np.empty((s, s))
    for log in range(m):
        V = C[log]
        for k in range(n):
            h = H[k, log % H.shape[1]]
            _clear(HC)
            _add(HC, h, V, 1.0)
            _seen_covariance(S, h, HC)
            logdet[k, log] = _inverse_root(S, R[k, log], root[k, log])
            _add(gain[k, log], root[k, log], HC, 1.0)
            _take_out(V, gain[k, log])
            if keep:
                _set(covariances[k, log], V)
            if k < len(A):
                _clear(T)
                _add(T, A[k, log % A.shape[1]], V, 1.0)
                _add(T, W[log], V, 1.0)
                _transpose(T, Tt)
                _set(T, Q[log])
                if not known[k]:
                    _add_diagonal(T, lost, 1)
                _add(T, A[k, log % A.shape[1]], Tt, 1.0)
                _add(T, W[log], Tt, 1.0)
                _symmetric(T, V)
                if is_last[k]:
                    _set(V, begun[log])
    return gain, root, logdet, covariances


@_compiled
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
    n, _, o, c = Z.shape
    m, s = gain.shape[1], W.shape[-1]
    white, states = np.zeros((n, m, o, c)), np.empty((n, m, s))
    missed, ahead = np.empty((o, c)), np.empty((s, c))
    for log in range(m):
        y = x[log]
        for k in range(n):
            _set(missed, Z[k, log % Z.shape[1]])
            _add(missed, H[k, log % H.shape[1]], y, -1.0)
            _add(white[k, log], root[k, log], missed, 1.0)
            _add_transposed(y, gain[k, log], white[k, log])
            for i in range(s):
                states[k, log, i] = y[i, 0]
            if k < len(A):
                _clear(ahead)
                _set(ahead, B[k, log % B.shape[1]])
                _add(ahead, A[k, log % A.shape[1]], y, 1.0)
                _add(ahead, W[log], y, 1.0)
                _set(y, ahead)
                if is_last[k]:
                    _clear(y)
    return white, states


@_compiled
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
    found, o, moved, left = np.empty((n, m, s)), white.shape[2], np.empty(s), np.empty(white.shape[2])
    for log in range(m):
        p = pull[log]
        for k in range(n - 1, -1, -1):
            if k < len(A):
                for i in range(s):
                    moved[i] = 0.0
                _add_product(moved, A[k, log % A.shape[1]], p)
                _add_product(moved, W[log], p)
                for i in range(s):
                    p[i] = 0.0 if is_last[k] else moved[i]
            _of_product(found[k, log], states[k, log], covariances[k, log], p, 1.0)
            _of_product(left, white[k, log], gain[k, log], p, -1.0)
            h, r = H[k, log % H.shape[1]], root[k, log]
            for i in range(o):
                share = 0.0
                for j in range(i, o):
                    share += r[j, i] * left[j]
                for j in range(s):
                    p[j] += h[i, j] * share
    return found


@_compiled
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
    known: np.ndarray,
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
    (n, o, s), m = H.shape, R.shape[1]
    x, C, found = np.zeros((s, m)), P.copy(), np.zeros(m)
    ahead, T = np.zeros((s, m)), np.zeros((s, s, m))
    rows, rows_ahead = C.reshape(s, s * m), T.reshape(s, s * m)
    rows_begun, rows_added = P.reshape(s, s * m), Q.reshape(s, s * m)
    for k in range(n):
        for i in range(o):
            if whole[k, i]:
                _take_in(x, C, rows, H[k, i], z[k, i], R[i], found)
        if k < n - 1:
            _clear(ahead)
            for i in range(b.shape[1]):
                for log in range(m):
                    ahead[i, log] = b[k, i]
            _add(ahead, A[k], x, 1.0)
            _add_each(ahead, W, x)
            _set(x, ahead)
            _clear(rows_ahead)
            _add(rows_ahead, A[k], rows, 1.0)
            _add_each(rows_ahead, W, rows)
            _transpose_each(T, C)
            _set(rows_ahead, rows_added)
            if not known[k]:
                _add_diagonal(rows_ahead, lost, m)
            _add(rows_ahead, A[k], rows, 1.0)
            _add_each(rows_ahead, W, rows)
            _symmetric_each(T, C)  # else what rounding makes of it grows over a long log
            if is_last[k]:
                _clear(x)
                _set(rows, rows_begun)
    return found


@_compiled
def _take_in(x, C, rows, h, z, R, found):
    """Take in one output: state, covariance and log-likelihood after it; `rows` is C with the logs in its rows."""
    s, m = x.shape
    seen, missed, S = np.zeros(s * m), np.full(m, z), R.copy()
    for j in range(s):
        if h[j] != 0.0:
            for log in range(m):
                missed[log] -= h[j] * x[j, log]
            for place in range(s * m):
                seen[place] += h[j] * rows[j, place]
    Ch = seen.reshape(s, m)
    for j in range(s):
        if h[j] != 0.0:
            for log in range(m):
                S[log] += h[j] * Ch[j, log]
    for log in range(m):
        found[log] -= 0.5 * (missed[log] * missed[log] / S[log] + np.log(S[log]))
        S[log] = 1.0 / S[log]
    share = np.empty(m)
    for i in range(s):
        for log in range(m):
            share[log] = Ch[i, log] * S[log]
            x[i, log] += share[log] * missed[log]
        for j in range(s):
            for log in range(m):
                C[i, j, log] -= share[log] * Ch[j, log]


@_compiled
def _clear(out):
    # loops here and below: what numba makes of slices takes several times as long to compile, and is slower
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = 0.0


@_compiled
def _set(out, X):
    """Set the first rows of `out` to X."""
    for i in range(X.shape[0]):
        for j in range(X.shape[1]):
            out[i, j] = X[i, j]


@_compiled
def _add_diagonal(out, M, m):
    """Add the diagonal of M to that of `out`, a (s, s m) array of m logs."""
    for i in range(M.shape[0]):
        for log in range(m):
            out[i, i * m + log] += M[i, i]


@_compiled
def _add_each(out, W, X):
    """Add W X to `out`, with W of each log and X a (s, c m) array with the logs in each column."""
    s, m = len(X), W.shape[2]
    for i in range(s):
        for j in range(s):
            if W[i, j, 0] != 0.0:
                for first in range(0, X.shape[1], m):
                    for log in range(m):
                        out[i, first + log] += W[i, j, log] * X[j, first + log]


@_compiled
def _add(out, M, X, sign):
    """Add M X to the first rows of `out`, or take it off; entries of M that are 0 cost nothing, and most are."""
    for i in range(M.shape[0]):
        for j in range(M.shape[1]):
            factor = sign * M[i, j]
            if factor != 0.0:
                for column in range(X.shape[1]):
                    out[i, column] += factor * X[j, column]


@_compiled
def _add_transposed(out, M, X):
    """Add M' X to `out`."""
    for j in range(M.shape[0]):
        for i in range(M.shape[1]):
            factor = M[j, i]
            for column in range(X.shape[1]):
                out[i, column] += factor * X[j, column]


@_compiled
def _add_product(out, M, v):
    """Add M' v to the first entries of `out`."""
    for i in range(M.shape[0]):
        factor = v[i]
        for j in range(M.shape[1]):
            out[j] += factor * M[i, j]


@_compiled
def _of_product(out, start, M, v, sign):
    """Set `out` to what it starts from plus M v, or less it."""
    for i in range(M.shape[0]):
        total = 0.0
        for j in range(M.shape[1]):
            total += M[i, j] * v[j]
        out[i] = start[i] + sign * total


@_compiled
def _seen_covariance(S, h, HC):
    """Covariance of the outputs, into the lower half of S."""
    for i in range(h.shape[0]):
        for j in range(i + 1):
            S[i, j] = 0.0
        for k in range(h.shape[1]):
            if h[i, k] != 0.0:
                for j in range(i + 1):
                    S[i, j] += h[i, k] * HC[j, k]


@_compiled
def _take_out(C, gain):
    """Take from a covariance what the outputs with these gains tell."""
    for k in range(gain.shape[0]):
        for i in range(gain.shape[1]):
            factor = gain[k, i]
            for j in range(gain.shape[1]):
                C[i, j] -= factor * gain[k, j]


@_compiled
def _transpose(M, out):
    for i in range(M.shape[0]):
        for j in range(M.shape[1]):
            out[j, i] = M[i, j]


@_compiled
def _transpose_each(M, out):
    """The same of each log, on the last axis."""
    for i in range(M.shape[0]):
        for j in range(M.shape[1]):
            for log in range(M.shape[2]):
                out[j, i, log] = M[i, j, log]


@_compiled
def _symmetric_each(M, out):
    """The mean of M and its transpose, of each log."""
    for i in range(M.shape[0]):
        for j in range(i + 1):
            for log in range(M.shape[2]):
                out[i, j, log] = 0.5 * (M[i, j, log] + M[j, i, log])
                out[j, i, log] = out[i, j, log]


@_compiled
def _symmetric(M, out):
    """The mean of M and its transpose."""
    for i in range(M.shape[0]):
        for j in range(i + 1):
            out[i, j] = out[j, i] = 0.5 * (M[i, j] + M[j, i])


@_compiled
def _inverse_root(S, R, inverse):
    """Logarithm of the determinant of S + diag(R); the inverse of its lower Cholesky factor goes into `inverse`."""
    o = S.shape[0]
    L, determinant = np.zeros((o, o)), 1.0
    for i in range(o):
        for j in range(i + 1):
            rest = S[i, j] + (R[i] if i == j else 0.0)
            for k in range(j):
                rest -= L[i, k] * L[j, k]
            L[i, j] = np.sqrt(rest) if i == j else rest / L[j, j]
        if np.isfinite(R[i]):
            determinant *= L[i, i]
        inverse[i, i] = 1.0 / L[i, i]
        for j in range(i):
            rest = 0.0
            for k in range(j, i):
                rest -= L[i, k] * inverse[k, j]
            inverse[i, j] = rest / L[i, i]
    return 2.0 * np.log(determinant)
