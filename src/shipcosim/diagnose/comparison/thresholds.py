"""Settings and thresholds of the comparison, each with its unit and what it was set on.

"Assumed" is what nobody has measured.
"""

# Smoothing

KERNEL = 1.5
"""Width of the kernel that accelerations are taken with, over the root of the ship's length over gravity."""
SHORTEST_KERNEL = 2.0
"""The least width. [rows]"""

# Regression

SOUND = 0.98
"""Share of the rows that is taken to be sound. Assumed."""
HUBER = 3.0
"""Standard deviations of the sound rows beyond which a row counts less."""
ROBUST_ROUNDS = 4
"""Rounds of reweighting."""
BLOCK_WIDTHS = 6.0
"""Widths of the kernel to a block of rows, over which errors are correlated."""
MOST_BLOCKS = 30
"""Blocks that a log is divided into at most."""

# What acts beside the thrusters

STEADY_SHARE = 0.3
"""Steady force that nobody explains, over what the thrusters are commanded: standard deviation. Assumed."""
TURNED_ROUND = 1.5
"""Turn in a log from which a steady force is taken as fixed in the earth's frame. [rad]"""
LEAST_COMMANDED = 0.05
"""Deviation of the commanded force on an axis over the measured force, below which the thrusters do not drive it."""
WEAKER_WAY = 0.2
"""Least gain astern over that ahead, and ahead over that astern, while the sides and signs of thrusters are judged.
Assumed: no propeller is dead one way."""

# Sides and signs of thrusters

CHANGE_COST = 3.0
"""What each change of the labels costs: 20 to 1 against a label that is wrong. [nats] Assumed."""
MOST_CHANGES = 2
"""Changes at once."""
SURELY_WRONG = 5.0
"""By how much another reading, after its cost, must beat the logged one to be beyond doubt. [nats] 150 to 1."""
PLAINLY_WRONG = 30.0
"""Evidence for another reading from which it need only predict the motion as well. [nats] A drawn healthy craft in a
zig-zag reached 21 (tests/bench/craft, seed 108), wrong labels on a simulated boat 44."""
RIVAL = 3.0
"""Readings closer than this cannot be told apart. [nats]"""
TOLD = 0.5
"""Least share of the measured force that the thrusters and the water explain on an axis, before it says anything of signs,
sides and sizes. In stationkeeping thrusters answer the weather, and their commands follow the weather: of
36 such logs with something hidden (seeds 700 to 717) three looked like wrong labels, which explained up to 0.29."""
SURELY_CAUSED = 8.0
"""By how much another reading must predict the next velocities better than the logged one, where the thrusters explain
less than `TOLD`. [nats] Drawn craft of tests/bench/craft, healthy, in closed loop and weather."""
CAUSAL_STEP = 0.4
"""Length of a block over which velocities and commands are averaged, over the root of the ship's length over gravity.
Assumed: shorter than a ship's fastest answer, longer than the noise."""
CAUSAL_ORDER = 8
"""Blocks of the past that a velocity is predicted from. Assumed: three of the times above."""
COMMANDS_BEFORE = 6
"""Blocks of commands before it. Assumed."""
GAIN_WIDTH = 0.7
"""Natural logarithm by which the gain of all thrusters may be off 1, standard deviation. Assumed: a factor of 2."""
GAIN_OF_AXES = 0.3
"""Natural logarithm by which the gain of an axis may differ from that of all, standard deviation. Assumed."""
LEAST_GAIN_STD = 0.05
"""Standard deviation of a gain to which it is never known better, whatever the rows say. Assumed."""
THRUSTER_WIDTH = 0.2
"""Standard deviation of a thruster's gain about that of all. Assumed."""
WAY_WIDTH = 0.4
"""Standard deviation of the gain ahead about that astern, of all thrusters. Assumed."""
LEAST_OF_ALL = 0.1
"""Share of their force that thrusters must have on an axis, before it is compared. Assumed."""
LEAST_LEVER = 0.3
"""The lever that makes it a moment, over the ship's length."""
AGREED = 5.0
"""By how much two of the fit, the foresight and the likelihood must each prefer a reading, after its cost. [nats]"""
CONTRADICTED = 15.0
"""By how much the third may speak against it. [nats] A controller that knows the motion better than the log does
feigns up to 10 in likelihood and 20 in foresight (tests/bench/craft, seeds 200 to 244, right labels)."""
LIKELIHOOD_LAGS = (0.0, 0.5, 1.0, 2.0)
"""Lags of the thrust of which the likelihood takes the best, over the root of the ship's length over gravity."""
ALIKE = 0.05
"""Readings are the same within this. [nats]"""
MOST_WEIGHED = 15
"""Most readings, the best-fitting ones, for which prediction and likelihood are computed beside the logged one."""
UNLIKELIER = 5.0
"""Evidence by which the likelihood may be lower where the fit alone decides. [nats] Seeds 236 and 300, right labels."""
BRAKES = 0.1
"""Correlation of commanded loads with the motion below which, by the labels, the thrusters brake the craft. As labelled
all of eleven logs of a boat with exchanged sides lie below 0, nine of them below -0.1."""
SURELY_BRAKES = 0.5
"""Negative correlation beyond which a reading cannot be right. A heading that is kept is braked a little: right
readings of drawn craft reach -0.31 (tests/bench/craft, seeds 7000 to 7049), both thrusters of a boat reversed -0.9."""
OPPOSITE = 4.0
"""Standard deviations by which a gain is surely positive, or surely negative. Assumed."""
LEAST_GAIN = 0.1
"""Gain below which thrusters do not follow their commands. Assumed."""
LAG_COST = 3.0
"""Cost of a lag against none, and of each further root of length over gravity. [nats] Assumed."""
LEAST_LAG = 2.0
"""Least lag that is reported. [rows]"""
LAGS = (0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0)
"""Lags of the thrust that are tried, over the root of the ship's length over gravity."""

# Gains

OFF = 0.3
"""Root mean square of the measured force less the model's over that of the commanded one, above which a model is far off.
Healthy small craft with noisy velocities reach 0.15 in yaw."""
LEAST_SUPPORT = 8.0
"""Log-likelihood that commanded loads must gain before their size is reported. [nats] As an unmodelled error."""
SURE_OF_GAIN = 3.0
"""Standard deviations that a gain must differ (assumed)."""
COMMON_SPREAD = 0.08
"""Natural logarithm by which a common ratio may differ from axis to axis: forms of a hull differ. Assumed."""
THRUSTER_SPREAD = 0.3
"""Share by which thrusters may differ from the gain that they have in common. Assumed."""
GROSS = 1.5
"""Factor of a common ratio of thrust to inertia from which it is corrected before anything else. No healthy ship of the
tolerances comes near, nor a lost third of one thruster."""
SURE_OF_RATIO = 2.0
"""Standard deviations by which a common ratio must exceed a limit; they include the difference of axes. Assumed."""
PLAIN = 1.3
"""Factor from which it is reported, where no cause in the catalogue explains the log. Loads of another form differ by as
much: zig-zags of a tanker's model, whose hull bears far more than her rudder, gave 1.2 to 1.4 of published numbers."""
LEAST_DAMPING = 0.05
"""Damping over the model's below which it is not reported: a hull that is unstable on her course has none to compare."""
LEAST_WAY = 0.15
"""Root mean square of thrust astern over that ahead, or the other way round, from which both are compared. Assumed."""
MENTIONED = 1.25
"""Factor from which a gain or a damping is a discrepancy."""
REMAINS = 0.1
"""Share of the mean square of the measured force from which an unexplained force is reported."""

LARGE = 0.7
"""Root mean square of what the model lacks over that of what the motion needs, above which an error is large: half of
the mean square is unexplained. Beyond 1 a model without any load would be nearer. Assumed."""
ABOVE_NOISE = 3.0
"""Root mean square of the missing load over that of velocity noise, for an error to be large. Assumed."""
STEADY = 0.7
"""Mean of the missing force over its root mean square, above which it is called steady."""
GOES_WITH = 0.3
"""Correlation above which the modelled force follows the needed force. Assumed."""

# Predictions

ANSWER = 1.7
"""Longest horizon over the middle of a ship's time constants: 60 s for a ship of 34 m at 1 m/s."""
SHORTEST_ANSWER = 10.0
"""The least, over the root of her length over gravity: model and ship may differ in their time constants. Assumed."""
LONGEST_ANSWER = 32.0
"""The most: 60 s for a ship of 34 m, beyond which weather rules, not the ship. Assumed."""
MOST_OF_LOG = 0.25
"""The most, as a share of the log."""
FEWEST_STARTS = 5
"""Predictions that a horizon must have."""
MOST_STARTS = 300
"""Predictions that are made at most."""

# What a log must have

RESOLVED = 1.5
"""Time from row to row up to which a log resolves a ship, over the root of her length over gravity: 2.8 s at 34 m. Her
fastest answer, sway with yaw at full speed, takes some 1 of these times; between rows farther apart thrusters and ship
do what the log does not have."""
FEWEST_USABLE = 60
"""Rows without gaps nearby from which commanded and measured force are compared."""
