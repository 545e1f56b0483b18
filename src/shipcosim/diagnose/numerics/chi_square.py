"""The chi-square distribution's upper tail, also far out where it is smaller than any float."""

import math

_TINY = 1e-300


def log_survival(value: float, degrees: float) -> float:
    """Logarithm of the probability that a chi-square variable exceeds a value.

    Parameters
    ----------
    value : float
        Not negative.
    degrees : float
        Of freedom, above 0, whole or not.

    Returns
    -------
    float

    References
    ----------
    Abramowitz and Stegun, Handbook of Mathematical Functions, 1964, 6.5.29 and 6.5.31: a power series of the lower
    tail, a continued fraction of the upper one, evaluated by Lentz's method.

    Examples
    --------
    With two degrees of freedom it is half the value:

    >>> log_survival(3000.0, 2.0)
    -1500.0
    """
    # The tail is the regularised upper incomplete gamma function Q(a, x).
    a = 0.5 * float(degrees)
    x = 0.5 * float(value)
    if not 0.0 < x < math.inf:
        return math.nan if math.isnan(x) else -math.inf if x > 0.0 else 0.0
    # Common factor x^a exp(-x) / gamma(a), as a logarithm against underflow.
    log_power = a * math.log(x) - x - math.lgamma(a)
    # The series converges fast below a + 1, the continued fraction above.
    if x < a + 1.0:
        return math.log1p(-math.exp(log_power) * _lower_series(a, x))
    return log_power + math.log(_upper_fraction(a, x))


def survival(value: float, degrees: float) -> float:
    """Probability that a chi-square variable exceeds a value; as `log_survival`.

    Examples
    --------
    >>> round(survival(3.841459, 1), 6)
    0.05
    """
    return math.exp(log_survival(value, degrees))


def _lower_series(a, x):
    """Sum of x**k / (a (a + 1) ... (a + k))."""
    # Each term follows from the one before by a factor x / (a + k).
    term = total = 1.0 / a
    k = a
    while term > 1e-17 * total:
        k += 1.0
        term *= x / k
        total += term
    return total


def _upper_fraction(a, x):
    """1 / (x + 1 - a - 1 (1 - a) / (x + 3 - a - 2 (2 - a) / (x + 5 - a - ...)))."""
    # Modified Lentz method: ratios of successive convergents, with a tiny number in place of 0.
    b = x + 1.0 - a
    c = 1.0 / _TINY
    d = 1.0 / b
    fraction = d
    change = 0.0
    k = 0
    while abs(change - 1.0) > 1e-15:
        k += 1
        numerator = k * (a - k)
        b += 2.0
        d = 1.0 / ((numerator * d + b) or _TINY)
        c = (b + numerator / c) or _TINY
        change = c * d
        fraction *= change
    return fraction
