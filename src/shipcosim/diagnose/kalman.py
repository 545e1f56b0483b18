"""The Kalman filter and the smoother over the rows of a log, compiled: the only loops that no array form takes away."""

import numpy as np
from numba import njit

__all__ = ["filtered", "smoothed"]


@njit(cache=True, error_model="numpy")
def filtered(A, B, H, Z, R, Q, P, known, lost, keep):
    """Whitened innovations of every column, by logs one after the other.

    Parameters
    ----------
    A : (m, n-1, s, s) array
        Transition of m logs.
    B : (m, n-1, s, c) array
        What moves the state besides, of c columns.
    H : (m, n, o, s) array
    Z : (m, n, o, c) array
    R : (m, n, o) array
        Variance of the outputs.
    Q, P : (m, s, s) array
        Covariance that a step adds, and that of the first state.
    known : (n,) bool array
        Whether what drives the ship over the step that follows is known; where not, `lost` is added too.
    lost : (s, s) array
    keep : bool
        Whether the state of the first column and its covariance are wanted.

    Returns
    -------
    tuple of arrays
        White innovations (m, n, o, c), logarithms of the determinants of their covariance (m, n), states (m, n, s) and
        covariances (m, n, s, s) after each row's measurement, the last two empty unless wanted.
    """
    m, n, o, c = Z.shape
    s = A.shape[-1]
    white, logdet = np.empty(Z.shape), np.empty((m, n))
    states, covariances = np.empty((m, n if keep else 0, s)), np.empty((m, n if keep else 0, s, s))
    for log in range(m):
        x, C = np.zeros((s, c)), P[log].copy()
        for k in range(n):
            PHt = C @ H[log, k].T
            Li = _inverse_root(H[log, k] @ PHt, R[log, k], logdet[log, k : k + 1])
            w = Li @ (Z[log, k] - H[log, k] @ x)
            gain = PHt @ Li.T
            white[log, k] = w
            x = x + gain @ w
            C = C - gain @ gain.T
            if keep:
                states[log, k], covariances[log, k] = x[:, 0], C
            if k < n - 1:
                x = A[log, k] @ x + B[log, k]
                C = A[log, k] @ C @ A[log, k].T + Q[log]
                if not known[k]:
                    C = C + lost
                C = 0.5 * (C + C.T)
    return white, logdet, states, covariances


@njit(cache=True, error_model="numpy")
def _inverse_root(S, R, logdet):
    """Inverse of the lower Cholesky factor of S + diag(R); the logarithm of its determinant goes into `logdet`."""
    o = S.shape[0]
    L, Li = np.zeros((o, o)), np.zeros((o, o))
    logdet[0] = 0.0
    for i in range(o):
        for j in range(i + 1):
            rest = S[i, j] + (R[i] if i == j else 0.0)
            for k in range(j):
                rest -= L[i, k] * L[j, k]
            L[i, j] = np.sqrt(rest) if i == j else rest / L[j, j]
        logdet[0] += 2.0 * np.log(L[i, i])
        Li[i, i] = 1.0 / L[i, i]
        for j in range(i):
            rest = 0.0
            for k in range(j, i):
                rest -= L[i, k] * Li[k, j]
            Li[i, j] = rest / L[i, i]
    return Li


@njit(cache=True, error_model="numpy")
def smoothed(A, b, Q, known, lost, states, covariances):
    """Rauch-Tung-Striebel smoother of one column.

    Parameters
    ----------
    A : (m, n-1, s, s) array
    b : (m, n-1, s) array
    Q, known, lost
        As for `filtered`.
    states, covariances
        As it gives them.

    Returns
    -------
    (m, n, s) array
    """
    m, n, s = states.shape
    found = np.empty((m, n, s))
    for log in range(m):
        found[log, n - 1] = x = states[log, n - 1]
        for k in range(n - 2, -1, -1):
            AP = A[log, k] @ covariances[log, k]
            ahead = AP @ A[log, k].T + Q[log]
            if not known[k]:
                ahead = ahead + lost
            predicted = A[log, k] @ states[log, k] + b[log, k]
            x = states[log, k] + AP.T @ np.linalg.solve(ahead, x - predicted)
            found[log, k] = x
    return found
