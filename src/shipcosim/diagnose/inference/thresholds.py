"""Thresholds by which causes are judged, each with its unit and what it was set on.

Those of the verdict were chosen on developing logs of the independent truth (tests/bench/truth, seeds below 1000), and
are measured on other seeds by the trial (docs/reports/diagnosis-trial.md). "Assumed" is what nobody has measured.
"""

import numpy as np

# The verdict

ENOUGH = 5.0
"""Log-evidence that a cause must gain over the log without it. [nats] 148 to 1, against some thirty hypotheses in all
their places."""
APART = 3.0
"""Sets of causes closer than this cannot be told apart. [nats] 20 to 1: closer, the second would be right too often."""
TESTABLE = 8.0
"""What a cause of typical size would have to gain, or this log could not have shown it. [nats] `ENOUGH` for its name,
and `APART` over the next."""
MORE_THAN_NOISE = 1.5
"""Times its standard deviation by which an estimate varies about the truth: noise and small errors of the model. Ten
planted causes in logs of the modelled ship (twin, seeds 0 and 1) were 1.3 off, root mean square."""
NINE_OF_TEN = 1.2816
"""Standard deviations above which a normal variable lies with a chance of 0.9 when its mean is that far above a limit."""
UNMODELLED = 8.0
"""An unmodelled error that gains more than this beside the best set means an unknown cause. [nats] Paid for the search
over its periods; from part to part of the log, and beyond tolerances, always."""
UNMODELLED_SHARE = 0.02
"""Gain of an unmodelled error over that of the causes, where that is more than `UNMODELLED`: the model of a large cause
is never exact to the last per cent (developing logs)."""
BESIDE_A_LARGE_CAUSE = 0.01
"""Such a share for errors that differ between parts of the log or exceed tolerances: a cause of a hundred times what
remains is named. On another simulator's logs, causes of 2068 nats were not, because of a remainder of 20."""
MOST_CAUSES = 2
"""Causes at once that are named. Where a third is needed, an unknown one is likelier than three at once."""
BESIDE_UNKNOWN = 0.5
"""Factor on the probability of a cause beside an error that no cause explains. Assumed: as likely as not it is only the
nearest of the known ones."""
SHAPE_CHANCE = 0.01
"""Probability of so large a deviation from the known shape, below which another cause is assumed. Two logs of one of some
forty developing ships pull at the headings like a wave drift of 1000 N without arm and surge."""
DEVIATIONS = 3.0
"""Standard deviations that an estimate must be off neutral (assumed)."""
STEADY_SET_LOSS = 12.0
"""Log-evidence that a set whose causes are equally large in all parts of the log may be below the best. [nats] What a
few wrong rows gave a cause on developing logs."""

# The form of the ship's loads

FORM_SCALES = (0.5, 1.0, 2.0)
"""How far the form may differ, over what is usual, among which the log chooses; and 0, the model's own. [1]"""
FORM_COST = 10.0
"""Log-evidence that another form must gain over the model's. [nats] Of 19 healthy developing logs of the model's form
one gained 24, the next 15; ten of another form gained 25 to 240 where the ship moved."""

# Gain on simulated healthy logs

NULL_GAIN_WITHOUT_WIND = 40.0
"""Further gain that a cause needs in a log without wind, which may be the true cause. [nats] Assumed."""
NULL_GAIN_OF_FORM = 5.0
"""More that a cause has to gain on a ship of another form than the model's, of which no reference tells: the form has
a few smooth functions, and what they leave looks like causes. [nats] Assumed, as much as `ENOUGH`."""
NULL_GAIN_UNKNOWN = 25.0
"""Gain that a healthy log may reach where no simulated ship keeps to the log's track, as a craft that cannot go
sideways. [nats] Assumed."""
FAR_ABOVE_NULL = 100.0
"""A gain above which no healthy logs are simulated. [nats] No healthy developing log came near."""
LOST_TRACK = 10.0
"""Squared innovations over their median among simulated healthy ships, above which the ship has lost the track. One
small craft in fifty spun away."""

# Unmodelled errors

BASIS_FUNCTIONS = 8
"""Basis functions over the log for a slow force."""
PERIODS = 28
"""Periods at which a sinusoidal force is sought, from 20 s to the length of the log."""
SHORTEST_PERIOD = 20.0
"""The shortest of them. [s]"""
FORCE_SIZE = 1e-3
"""Acceleration by a force that matters, the prior of unmodelled forces. [m/s2] 500 N on 500 t."""
CHANNEL_SIZES = (1.0, 1.0, np.radians(1.0), 0.03, 0.03, np.radians(0.03))
"""Error of a channel that matters, the prior of unmodelled errors of channels. [m, m, rad, m/s, m/s, rad/s] Assumed."""
LENGTHS_PER_GYRADIUS = 4.0
"""Lengths of a ship over her radius of gyration, to turn an acceleration into one in yaw."""
SIZE_FROM_PART_TO_PART = 0.1
"""Share of a cause's size by which its model may differ between parts of the log. Assumed."""
LEAST_LOG_P = -700.0
"""Logarithm of the smallest p-value; smaller ones are 0 to the machine."""

# Causes with a course

COURSE_GAIN = 30.0
"""What a cause with a course must gain over the best set of steady ones. [nats] Healthy developing ships of the model's
form gained at most 10, of another form at most 21 in nine of ten; a loss of 12 % from the middle of a log on 75."""
COURSE_BLOCK = 30.0
"""Time from one possible start or end of a course to the next. [s]"""
MOST_COURSE_BLOCKS = 80
"""In a log of more than 40 minutes they are farther apart."""
LIKELIEST_COURSES = 4
"""Causes that are fitted with a course, the likeliest of twice as many that are looked at closely."""
ROUNDS_OF_COURSE = 3
"""Rounds of linearisation of such a fit."""
CALM_WALK = 3e-6
"""Random walk of the unexplained acceleration beside which courses are sought, too. [m/s2.5] Healthy developing logs have
a third of it, one with a tow that came and went ten times it."""
WALK_IN_YAW = 0.12
"""Random walk in yaw over that of the other axes. [1/m] As tuned on the same logs."""
MEASURED_WHILE_PRESENT = 0.5
"""Share of the rows of a spell in which position and heading must be measured. Assumed: in most of them."""
SHORTEST_SPELL = 300.0
"""Spell of a cause whose rows are predicted by themselves. [s] Assumed."""
SIZES_OVER_TIME = 12
"""Parts of a log in which the size of a cause with a course is shown, each by itself."""

# Noise

MOST_WALK = 3e-5
"""Fastest random walk of the unexplained acceleration: some 400 N on a ship of 750 t in ten minutes. [m/s2.5] Left
free, it swallowed every cause (prototypes)."""
GUST_FACTOR = 10.0
"""Factor on the random walk where the wind is unknown. Assumed."""
TUNED_BESIDE = 3.0
"""Gain of a cause at first sight, above which noise is tuned beside it. [nats]"""
EXPLAINED_WALK = 1e-5
"""Random walk of the unexplained acceleration, below which a ship is explained. [m/s2.5] On developing logs (seeds 700 to
714) eight right ones reached 9e-6; five in which a wrong channel was explained by something else had 1e-5 to 3e-5."""
LEAST_WHITE = np.array([1e-3, 1e-3, 1e-4, 5e-4, 5e-4, 2e-5])
"""Least white noise of a channel. [m, m, rad, m/s, m/s, rad/s] A tenth or less of what good instruments of ships have. Set
on a run without instruments of a ship of 60 m: her averaged rows are off by more than the 3e-6 rad/s of the fit."""
LEAST_JOLT = 1e-4
"""Least white acceleration. [m/s1.5] Set on such a run of a ship of 12 m, whose thrusters move between rows of 0.5 s: below
it her fits went to and fro by fifty tolerances."""
LEFT_BY_ROWS = 0.01
"""The same of such a run, over its largest acceleration. [s0.5] Set on turning circles of ships of 12 and 60 m, whose units
turn by 10 deg from row to row: at 0.005 both were of another form than their own model."""
NOISE_MARGIN = 1.5
"""Factor on the noise that position and velocity leave room for. Assumed."""
NOISE_WIDTHS = (2.0, 4.0, 8.0)
"""Widths of the kernels that they are compared with. [rows]"""
SOUND = 0.98
"""Share of sound rows in a comparison. Assumed."""

# Predictions

FASTEST = 20.0
"""Speed at which a prediction that runs away is held. [m/s]"""
FASTEST_TURN = 5.0
"""Rate of turn at which it is held; boats of 1 m spin at 1. [rad/s]"""
REFERENCE_JOLTS = 3.0
"""Times the jolts that the reference is smoothed with, and seconds in which its force may change: the model moves it by
some 2 cm then."""
DRAWS = 1000
"""Draws of the bootstrap."""
