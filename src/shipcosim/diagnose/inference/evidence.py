"""Evidence for a cause: how much likelier a log is if its parameters may be as large as they typically are.

The whitened innovations are y = G θ + w. Every number of the ship is known within its tolerance, θ ~ N(0, spike²); a
cause that is present has θ ~ N(0, 1) in units of its typical size (slab). So small errors of known coefficients are no
cause.
"""

import numpy as np


def evidence(
    products: np.ndarray, prior: np.ndarray, centre: np.ndarray | None = None
) -> tuple[float, np.ndarray, np.ndarray]:
    """Log-evidence of a prior over that of θ = 0, and the posterior.

    Parameters
    ----------
    products : (1 + p, 1 + p) array
    prior : (p,) array
        Standard deviations; those of 0 are left out.
    centre : (p,) array, optional
        Where the columns were linearised, in the same units: the prior is about 0, the columns about there.

    Returns
    -------
    tuple of float, (p,) array, (p, p) array
        Log-evidence, mean and covariance of θ.
    """
    # Only columns with a prior variance take part.
    on = np.flatnonzero(prior > 0.0)
    G = products[1:, 1:]
    g = products[1:, 0]
    shift = 0.0
    # The prior is about 0: refer the innovations to θ = 0 where they were linearised elsewhere.
    if centre is not None and np.any(centre):
        shift = centre @ g + 0.5 * centre @ G @ centre  # y + G centre instead of y
        g = g + G @ centre
    # Scale by the prior's standard deviations S: S G S + I has no eigenvalue below 1, so its
    # Cholesky factor exists even for columns that are linearly dependent.
    scale = prior[on]
    inner = np.eye(on.size) + scale[:, None] * G[np.ix_(on, on)] * scale
    L = np.linalg.cholesky(inner)
    half = np.linalg.solve(L, scale * g[on])
    Li = np.linalg.inv(L) * scale
    # Posterior of a linear Gaussian model: covariance S (S G S + I)^-1 S, mean covariance times g.
    mean = np.zeros(prior.size)
    covariance = np.zeros((prior.size, prior.size))
    mean[on] = Li.T @ half
    covariance[np.ix_(on, on)] = Li.T @ Li
    # Log Bayes factor over θ = 0: half the explained sum of squares less half the log-determinant,
    # which penalises needless parameters.
    return float(0.5 * half @ half - np.log(np.diag(L)).sum() - shift), mean, covariance
