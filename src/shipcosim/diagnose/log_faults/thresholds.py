"""Thresholds by which faults of a log are found from the ship's response, each with its unit and what it was set on.

Developing logs are those of the independent truth (tests/bench/truth) with seeds below 1000. "Assumed" is what nobody
has measured.
"""

# Evidence for a fault against causes

FAULT = 15.0
"""What a fault of the data must gain over the best causes without it. [nats] It takes the place of causes that explain
the log too."""
UNIT = 3.0
"""Evidence that another unit must gain over a cause that it resembles (`wind_scale`): a scale is free, so the log in
knots is likelier than a wind load of exactly 1.94 squared. [nats]"""
MOST_TRIED = 3
"""Mislabels of thrusters and wind that are tried, the likeliest first."""
MOST_INPUT_FAULTS = 2
"""Faults of thrusters' and the wind's channels in one log. Assumed."""
ROUNDS_OF_SEGMENT = 2
"""Times that the segment of a mislabel is refined about the motion that it gives."""

# Labels of thrusters and wind

LEAST_ROW_GAIN = 10.0
"""Log-likelihood over the rows of its segment above which a mislabel is tried. [nats] Assumed."""
SHORTEST_INPUT = 60.0
"""Shortest segment in which an input is wrong. [s] Assumed."""
LAGS_TRIED = (2.0, 4.0, 6.0, 9.0)
"""Times by which the channel of one thruster may come late. [s] Assumed; a lag in between is found by its neighbour."""
WHOLE = 0.85
"""Share of the log above which a segment is taken as all of it. Assumed."""
SEARCH_STEP = 60.0
"""Time between the first candidates for the end of a segment. [s]"""
MOST_PLACES = 80
"""So many places at most; in a log of more than 80 minutes they are farther apart, as the time goes with both."""
FIRST_MOVE = 32
"""Rows by which an end is then moved, halved until it stays."""
SEGMENT_GAIN = 5.0
"""What another segment must gain over the one at hand. [nats] Assumed."""
PART_GAIN = 15.0
"""What a segment must gain over the whole log. [nats] Assumed."""

# Channels of thrusters and wind that are held

HELD_EXCESS = 150.0
"""How much likelier the innovations of the other rows are than those of all rows as logged. [nats] Of the independent
truth, stops of thrusters that did stand still reach 93 (18 stops; seeds 98602, 98603, 98700, 98701), channels that are
held 118 to 962 (5 logs, seed 98500; two of them stay below)."""
HELD_ALIKE = 0.9
"""Share of the held rows of a channel in which another one is held too, to be the same gap. Assumed."""

IDLE = 0.05
"""Speed of a shaft over the largest it can have, below which its direction hardly matters: 0.3 % of its thrust. Assumed."""
CALM_AIR = 0.05
"""Wind over ground over the ship's own speed, below which what she feels is her own way. Assumed."""

# Labels of the navigation

LABEL_GAIN = 30.0
"""What a label must gain over the rows of its stretch. [nats] Healthy logs gained up to 7 in a stretch, faulty ones up
to 20 by another label."""
BETTER_LABEL = 15.0
"""More than what position against velocity has said. [nats] The same logs."""
SHORTEST_LABEL = 180.0
"""Shortest stretch; along shorter ones other causes look like labels (developing logs). [s]"""
CHANGED = 0.7
"""Share of the root mean square of its channels that another frame must change. Assumed."""
LIKELY_LABELS = 4
"""Labels for which the noise is tuned again."""
CALM_JOLT = 0.2
"""Share of the first guess of the jolts that the noise may have: under a wrong label jolts grow to cover it."""

# The clock

CLOCK_GAIN = 8.0
"""What a wrong clock must gain after the cost of choosing its segments. [nats]"""
OVER_CAUSE = 5.0
"""More than the likeliest cause. [nats]"""
CLOCK_BLOCK = 12.0
"""Blocks of which its segments consist. [s]"""
MOST_BLOCKS = 400
"""In a log of more than 80 minutes blocks are longer: time and memory go with rows times blocks."""
SHORTEST_CLOCK = 60.0
"""Shortest segment. [s]"""
LARGEST_SHARE = 0.5
"""Largest share of the log; what is longer is a scale, not a segment."""
MOST_SEGMENTS = 2
"""Segments of one clock."""
PLAUSIBLE_RATES = (0.65, 1.5)
"""ρ of a clock; outside it is noise (developing logs)."""
SMALLEST_RATE = 0.08
"""Deviation of ρ from 1 below which the clock counts as right. Assumed."""
RATE_UNSURE = 0.03
"""Standard deviation of ρ from the ends of segments. Assumed."""
ASPECT_APART = 0.15
"""Difference of ρ by distance, speed, heading and turning that may go beyond noise. Assumed."""
ASPECT_CHANCE = 0.01
"""Probability that they differ more if the clock is wrong; the limit is 11.3. 28 of 30 developing logs with a wrong
clock lay below 10.1; 17 of 19 in which a shoal, a wind shadow or a deviating compass looked like one, above 14."""
MOTION_GAIN = 6.0
"""What way and heading by themselves must gain by a wrong clock. [nats] Logs with one gain 6.5 to 615 where it is found
(developing, hold 9801 to 9811, work 9801 to 9806); of nine runs in swell without one that get here eight lose 1 to 11,
one gains 5.4."""
END_BLOCK = 2.0
"""Blocks of which the ends of its segments are settled. [s]"""
ENDS_TRIED = 10
"""Blocks on either side of an end."""
ROUNDS_OF_CLOCK = 2
"""How often ends and rate are settled, each about the motion that those before tell of."""
TYPICAL_RATE = 0.2
"""ρ - 1 of a wrong clock that a log should be able to show, for what it could not have shown."""
TYPICAL_SEGMENT = 240.0
"""Its length. [s]"""
