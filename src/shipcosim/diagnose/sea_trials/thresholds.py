"""Thresholds of the sea trials: what counts as a manoeuvre, and how well a model is expected to meet its features.

Lengths of time and way are those of ships of similar form at similar Froude number: they go with L and the root of L.
"""

TURNING = 0.14
"""Steering, as commanded yaw moment over commanded thrust and lever, above which a ship is turned: sin 8 deg. [1]"""
STEADY = 0.035
"""Steering below which a ship is kept straight: sin 2 deg. [1]"""
ZIG_ZAG = 0.06
"""Steering of a helm in a zig-zag. [1]"""
CIRCLE = 330.0
"""Heading turned by a circle that can be used, from the start of the order. [deg]"""
HALF_A_CIRCLE = 180.0
"""Change of heading after which a circle is steady: speeds of the trials of 2022 change little after it. [deg]"""
DRIFT_TOLD = 270.0
"""Change of heading in a steady circle after which the drift of its centre gives the current. [deg]"""
CIRCLES = 540.0
"""Heading turned up to which a circle is used. [deg]"""
SWINGS = 3
"""Changes of the helm of a zig-zag that can be used. [1]"""
LONGEST_SWING = 20.0
"""Largest distance between changes of the helm in a zig-zag. [ship lengths]"""
REVERSED = 2.0
"""Way over which the helm of a zig-zag is put over from side to side. [ship lengths]"""
SETTLED = 15.0
"""Way after a manoeuvre until the speed has settled: exp(-3) of a difference is left. [ship lengths]"""
STRAIGHT = 8.0
"""Way of a straight run that can be used. [ship lengths]"""
STRAIGHT_RATE = 0.03
"""Yaw rate r L / U of a straight run, averaged over the time of rest: a curve of 33 lengths radius. [1]"""
REST = 10.0
"""Time over which a helmsman's corrections average out, and orders are held. [s]"""
CLIPPED = 0.98
"""Ordered over largest shaft speed, above which the order does not give the true shaft speed. [1]"""
RUN = 40.0
"""Way over which the model settles to its own speed. [ship lengths]"""
FROUDE = 0.2
"""Froude number from which a run to settled speed starts. [1]"""
LONGEST_HOLE = 6
"""Rows without a value that are bridged. [1]"""
CLOCK_WINDOW = 1.4
"""Over which way and logged speed are compared, times the root of the length in m: 8 s for 34 m. [s/m^0.5]"""
STEP = 0.086
"""Step of the simulation, times the root of the length in m: 0.5 s for 34 m. [s/m^0.5]"""
TURNS = 0.2
"""Yaw rate in ship lengths turned per length sailed, r L / U, above which heading and rate tell the clock. [1]"""
UNDER_WAY = 0.03
"""Froude number below which a ship makes no trials. [1]"""
RPM_LAG = 1.0
"""With which a propeller follows its order, assumed. [s]"""

HEADINGS = (20.0, 60.0, 90.0, 180.0)
"""Headings turned whose times are compared. [deg]"""
HEADINGS_OF_SPEED = (40.0, 90.0, 180.0)
"""Headings turned at which speeds are compared. [deg]"""

SPEED = 0.025
RATE = 0.025
DRIFT = 0.026
"""How well the steady speed, rate (shares) and drift angle (rad) of a circle repeat, assumed: waves, wind, helm."""
TIMES = (0.10, 0.06, 0.05, 0.04)
"""How well the times to `HEADINGS` repeat, assumed. [1]"""
SPEEDS = 0.05
"""How well the speeds at `HEADINGS_OF_SPEED` repeat, assumed. [1]"""
WAYS = (0.04, 0.06, 0.04)
"""How well advance, transfer and tactical diameter repeat, assumed. [1]"""
STRAIGHT_SPEED = 0.015
"""How well the speed of a straight run repeats, apart from the current, assumed. [1]"""
PEAK_RATE = 0.04
SWING = 0.08
ZIG_ZAG_SPEED = 0.03
"""How well mean largest rate, mean heading change and mean speed of a zig-zag repeat, assumed. [1]"""
PULL_OUT_RATE = 0.04
SPIRAL_RATE = 0.03
CHANGED_SPEED = 0.025
TURNED = 0.1
"""How well these repeat: the rates of a pull-out and a spiral over the first, of a changing speed over the first
(shares), and of the change of heading while a course is held (rad), assumed."""
START = 0.12
"""How well the start of a circle's order is known, times the root of the length in m: 0.7 s for 34 m. [s/m^0.5]"""
COMMON = 0.02
"""What all speeds of a manoeuvre, and all its rates, share: another rpm than logged, a heel, a gust, assumed. [1]"""
SCALES = (0.7, 1.0, 1.4, 2.0, 2.8, 4.0)
"""Factors on all of these among which the one of most evidence is taken. [1]"""

CURRENT = 0.25
"""Prior of a steady current in each direction. [m/s]"""
HEADING_BIAS = 0.052
"""Prior of what the compass is off: 3 deg. [rad]"""
LEVER = 0.118
"""Prior of how far the antenna is off the origin ahead, as a share of the length. [1]"""

UNTOLD = 0.5
"""Squared size of a cause's typical effect in the features' standard deviations, below which trials say nothing of
it: its spread falls by less than a fifth. [1]"""
MOST_CAUSES = 3
"""Causes that are sought at once. [1]"""
RELINEARISED = 8
"""Sets, best in the linear approximation, that are fitted to the simulation itself. [1]"""
ROUNDS = 2
"""Times that they are linearised again. [1]"""
NAMED = 5.0
"""Evidence that each cause of a set must add. [nats]"""
RIVAL = NAMED
"""Evidence within which a set counts as fitting alike: a cause that must add so much to be named must lead another by
as much. With 3 nats a hidden inertia in yaw was once named late orders. [nats]"""
