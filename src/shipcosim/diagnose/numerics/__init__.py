"""Numerical methods of the diagnosis beside NumPy's: filters, splines, recursions, least squares, chi-square.

They are few and small, so that SciPy need not be installed; the tests hold them against SciPy.
"""

from shipcosim.diagnose.numerics.bands import Bands
from shipcosim.diagnose.numerics.chi_square import log_survival, survival
from shipcosim.diagnose.numerics.filters import gaussian_filter, moving_average
from shipcosim.diagnose.numerics.finite import finite, usual_rise
from shipcosim.diagnose.numerics.least_squares import least_squares
from shipcosim.diagnose.numerics.quantiles import quantile
from shipcosim.diagnose.numerics.root_mean_square import root_mean_square
from shipcosim.diagnose.numerics.sequences import between, places, running_sums, runs, trapezium
from shipcosim.diagnose.numerics.splines import spline_integral
from shipcosim.diagnose.numerics.tridiagonal import solve_tridiagonal
from shipcosim.diagnose.numerics.white_noise import noise_by_differences, normal_size

__all__ = [
    "Bands",
    "between",
    "finite",
    "gaussian_filter",
    "least_squares",
    "log_survival",
    "moving_average",
    "noise_by_differences",
    "normal_size",
    "places",
    "quantile",
    "root_mean_square",
    "running_sums",
    "runs",
    "solve_tridiagonal",
    "spline_integral",
    "survival",
    "trapezium",
    "usual_rise",
]
