"""Settings and thresholds of predictions and gains, each with its unit and what it was set on.

"Assumed" is what nobody has measured.
"""

import numpy as np

# Rows to fit on and to check on

TRAINED = 0.65
"""Share of the log, from its start, that is fitted on by default."""
START_STEP = 5.0
"""Time from the start of one prediction to the next. [s]"""
SETTLED = 120.0
"""Time after which observers have learnt. [s] Assumed."""
MEASURED_WITHIN = 2.0
"""Within which a measurement has to be where a prediction starts or ends. [s]"""
TURNING = np.radians(15.0)
"""Turn within a prediction that makes it a turn. [rad]"""
MOVING = 0.25
"""Mean speed that makes it a move. [m/s]"""
STANDING = 0.05
"""Share of its largest speed in the log below which a thruster stands still."""
LEAST_TRAINED = 0.5
"""Share of the rows that must be left to fit on where a condition is held out."""
FEWEST_PREDICTIONS = 12
"""Fewest predictions on such a condition."""

# Observers and intervals

FADES = (0.0, 1.0 / 40.0)
"""Rates at which the force of a bias observer fades in a prediction; the best on the training rows is taken. [1/s]"""
BLOCK = 120.0
"""Blocks of the bootstrap: two of the longest horizon. [s]"""
FEWEST_INTERVAL_BLOCKS = 3
"""Fewest blocks for an interval of a part of the predictions."""

# Errors of healthy ships

HEALTHY_SHIPS = 100
"""Healthy ships whose largest error a log must exceed before it is no longer consistent. Of 26 healthy developing logs
(seeds 94000 to 94025) none came above 0.9 of it."""
FLOOR_VARIES = 1.5
"""Factor on the noise floor of a log that chance may bring. Assumed: of some ten independent predictions."""

# Missing force

FORCE_TIME = 10.0
"""Time within which the missing force may change; faster, noise is taken for force. [s]"""
SECTORS = 24
"""Sectors of an angle in which the force is averaged."""
FEWEST_SECTOR_ROWS = 5
"""Fewest rows of a sector."""

# Co-simulations

STEP = 0.1
"""Step of the co-simulations. [s]"""
MOST = 24
"""Predictions that are co-simulated."""
INPUT_DELAY = 1.5
"""Steps from a row of the table until what it drives has moved the ship."""
WEATHER_RATE = 1e3
"""Rates of the weather, so that it follows a log at once. [m/s2, rad/s]"""

# Tracks: a log predicted piece by piece

TIME_CONSTANTS = 10.0
"""Length of a prediction in the craft's slowest time constant. Assumed."""
SHORTEST_HORIZON = 10.0
LONGEST_HORIZON = 60.0
"""Bounds of that length. [s] Assumed."""
LEAST_SHARE = 0.24
"""Share of a log that a prediction takes at most."""
SMOOTHED_SHARE = 1.0 / 60.0
"""Time over which measurements are averaged for the start of a prediction, over its length; 4 s at most."""
MOST_ROWS = 4000
"""Rows of a simulation that are drawn."""
LEAST_GAIN = 0.95
"""Error of predictions with the named causes over that without, of position or of heading, below which they gain. Of 27
right names of another simulator's logs the least gain was 0.91; a form that the tunnel's place stood for gave 0.96."""
WORSE = 1.02
"""Error of predictions with the named causes over that without, above which they are not named. Assumed: what a cause
that does not matter on the rows kept from the fit changes by chance."""
