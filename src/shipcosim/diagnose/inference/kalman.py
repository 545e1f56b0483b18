"""Kalman filter and smoother over the rows of a log. They are recursive, hence compiled with numba.

What the filter weighs measurements by depends on the problem and its noise alone, not on the columns that are filtered:
it is computed by itself, and serves any number of columns, now or later. Rows come first in all arrays, then logs; an
array that is the same for all logs has one.
"""

import numpy as np
from numba import njit

__all__ = ["log_likelihoods", "smoothed", "weights", "whitened"]

_compiled = njit(cache=True, error_model="numpy")


@_compiled
def weights(
    A: np.ndarray,
    W: np.ndarray,
    H: np.ndarray,
    R: np.ndarray,
    Q: np.ndarray,
    P: np.ndarray,
    known: np.ndarray,
    lost: np.ndarray,
    keep: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Gains of the filter.

    Parameters
    ----------
    A : (n-1, m or 1, s, s) array
        Transition of m logs.
    W : (m, s, s) array
        What of it does not change from row to row, added to A.
    H : (n, m or 1, o, s) array
    R : (n, m, o) array
        Variance of the outputs; infinite where there is none.
    Q, P : (m, s, s) array
        Covariance that a step adds, and that of the first state.
    known : (n,) bool array
        Whether what drives the ship over the step that follows is known; where not, `lost` is added too.
    lost : (s, s) array
    keep : bool
        Whether the covariances are wanted.

    Returns
    -------
    tuple of arrays
        What a white innovation adds to the state (n, m, s, o), what turns an innovation into a white one (n, m, o, o),
        logarithms of the determinants of their covariance (n, m), covariances of the state after each row's measurement
        (n, m, s, s), empty unless wanted.
    """
    n, m, o = R.shape
    s = A.shape[-1]
    gain, root, logdet = np.empty((n, m, s, o)), np.zeros((n, m, o, o)), np.empty((n, m))
    covariances = np.empty((n if keep else 0, m, s, s))
    HC, S, Gt, F, T = np.empty((o, s)), np.empty((o, o)), np.empty((o, s)), np.empty((s, s)), np.empty((s, s))
    for log in range(m):
        C = P[log].copy()
        for k in range(n):
            h = H[k, log % H.shape[1]]
            HC[:] = 0.0
            _add(HC, h, C, 1.0)
            S[:] = 0.0
            _add(S, h, HC.T, 1.0)
            logdet[k, log] = _inverse_root(S, R[k, log], root[k, log])
            Gt[:] = 0.0
            _add(Gt, root[k, log], HC, 1.0)
            gain[k, log] = Gt.T
            _add(C, gain[k, log], Gt, -1.0)
            if keep:
                covariances[k, log] = C
            if k < n - 1:
                F[:] = A[k, log % A.shape[1]]
                F += W[log]
                T[:] = 0.0
                _add(T, F, C, 1.0)
                _transpose(T, C)
                T[:] = Q[log]
                if not known[k]:
                    T += lost
                _add(T, F, C, 1.0)
                _symmetric(T, C)
    return gain, root, logdet, covariances


@_compiled
def whitened(
    A: np.ndarray, W: np.ndarray, B: np.ndarray, H: np.ndarray, Z: np.ndarray, gain: np.ndarray, root: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Whitened innovations of every column, and the state of the first.

    Parameters
    ----------
    A, W, H
        As for `weights`.
    B : (n-1, m or 1, b, c) array
        What moves the first b states besides, of c columns.
    Z : (n, m or 1, o, c) array
        Outputs.
    gain, root
        As `weights` gives them.

    Returns
    -------
    tuple of (n, m, o, c) array, (n, m, s) array
        White innovations; state of the first column after each row's measurement.
    """
    n, _, o, c = Z.shape
    m, s = gain.shape[1], A.shape[-1]
    white, states = np.zeros((n, m, o, c)), np.empty((n, m, s))
    missed, ahead, F = np.empty((o, c)), np.empty((s, c)), np.empty((s, s))
    for log in range(m):
        x = np.zeros((s, c))
        for k in range(n):
            missed[:] = Z[k, log % Z.shape[1]]
            _add(missed, H[k, log % H.shape[1]], x, -1.0)
            _add(white[k, log], root[k, log], missed, 1.0)
            _add(x, gain[k, log], white[k, log], 1.0)
            states[k, log] = x[:, 0]
            if k < n - 1:
                F[:] = A[k, log % A.shape[1]]
                F += W[log]
                ahead[:] = 0.0
                ahead[: B.shape[2]] = B[k, log % B.shape[1]]
                _add(ahead, F, x, 1.0)
                x, ahead = ahead, x
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
) -> np.ndarray:
    """Smoothed state of one column, by the adjoint form of Bryson and Frazier (1963): no matrix is inverted.

    Parameters
    ----------
    A, W, H
        As for `weights`.
    white : (n, m, o) array
    gain, root, states, covariances
        As `weights` and `whitened` give them.

    Returns
    -------
    (n, m, s) array
    """
    n, m, s = states.shape
    found = np.empty((n, m, s))
    for log in range(m):
        pull = np.zeros(s)  # of what is measured later, on the state
        for k in range(n - 1, -1, -1):
            found[k, log] = states[k, log] + covariances[k, log] @ pull
            left = white[k, log] - gain[k, log].T @ pull
            pull = pull + H[k, log % H.shape[1]].T @ (root[k, log].T @ left)
            if k > 0:
                pull = (A[k - 1, log % A.shape[1]] + W[log]).T @ pull
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
) -> np.ndarray:
    """Log-likelihood of one log under several noises, side by side, up to a constant.

    Outputs are taken one after the other, which comes to the same: no matrix is inverted.

    Parameters
    ----------
    A : (n-1, s, s) array
    W : (s, s, m) array
        What of the transition is a matter of the noise, added to A.
    b : (n-1, r) array
        What moves the first states besides.
    H : (n, o, s) array
    z : (n, o) array
    whole : (n, o) bool array
        Where there is an output.
    R : (o, m) array
        Variance of the outputs.
    Q, P : (s, s, m) array
    known, lost
        As for `weights`.

    Returns
    -------
    (m,) array
    """
    (n, o, s), m = H.shape, R.shape[1]
    x, C, found = np.zeros((s, m)), P.copy(), np.zeros(m)
    ahead, T = np.zeros((s, m)), np.zeros((s, s, m))
    rows, rows_ahead = C.reshape(s, s * m), T.reshape(s, s * m)
    for k in range(n):
        for i in range(o):
            if whole[k, i]:
                _take_in(x, C, rows, H[k, i], z[k, i], R[i], found)
        if k < n - 1:
            ahead[:] = 0.0
            for i in range(b.shape[1]):
                ahead[i] += b[k, i]
            _add_each(ahead, A[k], W, x)
            x[:] = ahead
            T[:] = 0.0
            _add_each(rows_ahead, A[k], W, rows)
            _transpose(T, C)
            T[:] = Q
            if not known[k]:
                for i in range(s):
                    T[i, i] += lost[i, i]  # and nothing beside the diagonal
            _add_each(rows_ahead, A[k], W, rows)
            _symmetric(T, C)  # else what rounding makes of it grows over a long log
    return found


@_compiled
def _take_in(x, C, rows, h, z, R, found):
    """Take in one output: state, covariance and log-likelihood after it; `rows` is C with the logs in its rows."""
    s, m = x.shape
    seen, missed, S = np.zeros(s * m), np.empty(m), R.copy()
    missed[:] = z
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
def _add_each(out, A, W, X):
    """Add (A + W) X to `out`, both (s, c m) arrays with the logs in each column, of which A is the same for all."""
    s, m = len(X), W.shape[2]
    for i in range(s):
        for j in range(s):
            if A[i, j] != 0.0:
                for place in range(X.shape[1]):
                    out[i, place] += A[i, j] * X[j, place]
            if W[i, j, 0] != 0.0:
                for first in range(0, X.shape[1], m):
                    for log in range(m):
                        out[i, first + log] += W[i, j, log] * X[j, first + log]


@_compiled
def _add(out, M, X, sign):
    """Add M X to `out`, or take it off; entries of M that are 0 cost nothing, and most are."""
    for i in range(M.shape[0]):
        for j in range(M.shape[1]):
            factor = sign * M[i, j]
            if factor != 0.0:
                for column in range(X.shape[1]):
                    out[i, column] += factor * X[j, column]


@_compiled
def _transpose(M, out):
    for i in range(M.shape[0]):
        for j in range(M.shape[1]):
            out[j, i] = M[i, j]


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
