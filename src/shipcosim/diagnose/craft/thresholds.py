"""Thresholds of learning a craft. Those without another origin are assumed."""

FACTOR_E = 1.72
"""Standard deviation of a number about the file's, over that: e - 1, so that a factor of e is one of them."""
"""Parts of a log that are held out in turn."""
MOST_PARTS = 10
FEWEST_PARTS = 4
PART = 2.0
"""Least length of a part, over the longest horizon."""
MOST_STARTS = 120
"""Predictions from one log."""
STEPS = 6
"""Linearisations of the accelerations: they are linear in all numbers but the inertia."""
SURE = 2.0
"""Standard errors by which one more number has to lower the error on held-out parts."""
LEAST_GAIN = 0.01
"""Natural logarithm of the error on held-out parts by which a number has to lower it."""
MOST_NUMBERS = 20
"""Numbers of a craft at most."""
MOST = 3.0
"""Natural logarithm of a number over the file's at most: a factor of twenty."""
NOT_WORSE = 1.02
"""Error of headings over the given ship's up to which it is no worse."""
DRIVING = 0.05
"""Energy that the water may give a craft over what it takes: couplings are learned with noise."""
LARGEST_STEP = 0.7
"""Change of a logarithm in one step at most: a factor of two."""
TYPICAL_CURRENT = 0.25
"""Current in each direction that may take the place of another craft, standard deviation. [m/s] As of sea trials."""
