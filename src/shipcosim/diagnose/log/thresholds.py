"""Thresholds of the checks of a log by its own channels, each with its unit and what it was set on.

The checks were developed on logs of the independent truth (tests/bench/truth, seeds below 1000); where nothing else
is given, what a number was set on was not recorded. "Assumed" is what nobody has measured.
"""

# Rows that are no measurement

SHORTEST_GAP = 10.0
"""Shortest gap; below it is an ordinary dropout. [s] Assumed."""
FEWEST_GAP_ROWS = 5
"""Fewest rows of a gap. Assumed."""
RUN_CHANCE = 1e-7
"""Probability of a run of equal or straight values that long anywhere in a log, below which data was lost."""
FEWEST_CONSTANT = 30
"""Rows above which a channel that never changes is one without life. Assumed."""
CHANGES = 20.0
"""Range of a channel over its noise and resolution that is a change. Assumed."""
FEWEST_OTHERS = 0.3
"""Share of a log outside of runs that must be there to say that runs are unusual. Assumed."""
MOST_FLAGGED = 0.6
"""Share of these rows that are held or straight, above which a channel is too coarse to say so. Assumed."""
NOISE_SEEN = 0.75
"""Noise of a channel over its resolution, above which it is seen. By the same differences rounding alone is noise of
0.35 to 0.6 steps."""
LONGEST_WRAP = 6
"""Most samples of the heading that are interpolated across north. Assumed."""
NEAR_NORTH = 45.0
"""Headings that are near north. [deg]"""
NO_TURN = 15.0
"""Change of heading from row to row that can be one interpolated across north. [deg] Assumed."""
FASTER = 5.0
"""Over what three in five changes of a log stay below, above which it is no turn of the craft. Assumed."""
LEAP = 5.0
"""Way between two rows over that by the logged velocity, above which rows were lost. Assumed."""
END_DISTANCE = 10.0
"""Distance of the first or last sample of a channel from the middle of all others over their range, above which it is
no measurement: it has one neighbour only. Start-up rows were off by millions. Assumed."""
FEWEST_LEAPS = 3
"""Rows in which the ship leaps: a single leap can be another reference."""

# Readings of the channels of a whole log

FEWEST_INCREMENTS = 6
"""Half the rows of a log that a relation needs. Assumed."""
FEWEST_FITTED = 24
"""Rows that can be compared with the one before, that a relation needs. Assumed."""
MOST_FITTED = 6000
"""Rows that a relation is fitted to; of longer logs every so many are taken."""
MOST_CHANGE = 2.0 / 3.0
"""Share of the rows in which a position or heading must change; else every second row is taken, and so on. Half was too
few: a boat's positions came in 0.499 or 0.501 of the rows of its parts, and only the first were thinned."""
FIT_CLIP = 4.0
"""Standard deviations beyond which a row counts no more."""
NOISIER = 2.0
"""Variance of what is left in a part of a log over that in its calm parts, above which it is more than noise.
Assumed."""
CALM_SHARE = 0.25
"""Share of the parts of a log that are calm."""
NOISIER_PART = 4.0
"""Noise of a channel in a part of a log over that elsewhere, from which on a remark gives both. Assumed."""
NOISIER_PART_GAIN = 30.0
"""What a noisier part must gain over noise that is the same throughout. [nats] Assumed."""
NOISIER_PART_CLIP = 3.0
"""Most that one row can gain by it: outliers are no noise. [nats] Assumed."""
UNSURE_NOISE = (0.25, 0.35, 0.15)
"""Uncertainty of the loss that noise causes in a factor, which is measured in two ways: how far from the larger to the
smaller the value is taken, how unsure it is as a share of their difference, and as a share of the larger even where
both agree. Set on hold logs of seeds 200 to 213: 28 factors are off by 0.6 of their stated error, as a root mean
square."""
HEARD = 12.0
"""What the best form of a relation must gain over none, to be heard. [nats] Assumed; of 36 forms without any relation
the best one gains 5."""
UNKNOWN_SIZE = 3.0
"""Standard deviation of a factor's logarithm from which on its relation says nothing. Assumed."""
LARGEST_TURN = 75.0
"""From row to row, beyond which rows are too far apart to follow the motion. [deg] Assumed."""
TURNED_TOO_FAR = 0.05
"""Share of the rows that may turn further."""
ALONGSIDE = 30.0
"""By how much nine in ten headings may be off what the yaw rate tells from row to row, to count turns by it. [deg]
Assumed."""
RELATION_WINDOWS = 16
"""Windows of a log that are compared with each other."""
ROBUST_SHARE = 0.8
"""Share of them that a relation is found in, those that agree best: data may be lost in the others."""
ROBUST_ROUNDS = 3
"""Rounds of choosing them."""
SCALE_TOLERANCE = (0.007, 0.08)
"""By how much velocity and position of a right log differ in scale, as standard deviations: of most, and of a few.
Assumed."""
RATE_TOLERANCE = (0.012, 0.08)
"""Standard deviations of the scale between yaw rate and heading: of most logs, and of a few. Assumed."""
ANGLE_TOLERANCE = (0.02, 0.1)
"""Standard deviations of the angle between velocity and change of position. [rad] Assumed."""
FAR_SHARE = 0.03
"""Share of those few. Assumed."""
GOES_AHEAD = 0.8
GOES_ASTERN = 0.05
"""Shares of logs in which a craft that has one course against her bow goes ahead or astern; the rest goes anywhere.
Assumed."""
DRIFT = 0.25
"""By how much such a course is off the bow, beyond what it varies by. [rad] Assumed."""
ONE_COURSE = 0.9
"""Length of the mean direction of the velocity against the bow, fast rows counting for more, above which it is one
course. Ships that work at low speed went sideways at up to 0.82, in truth's logs of seeds 200 to 207."""
COMPASS_OFF = 20.0
"""Angle by which a compass is off at most; positions that are turned further are in a grid that is turned. [deg]
Assumed."""
USUAL_SPEED = (1.0, 6.0)
"""Speed of craft, and the factor by which most are slower or faster: [m/s, 1]. Assumed."""
USUAL_STEP = (0.5, 8.0)
"""Time from row to row of logs, and such a factor. [s, 1] Assumed."""
UNEXPLAINED_COST = 14.0
"""Cost of something that no combination of two changes explains. [nats] Assumed."""
FEWEST_WIND_ROWS = 100
"""Fewest rows with wind for the wind to count. Assumed."""
WIND_ROWS = 4.0
"""Standard deviation of the bell over the velocity that the wind is compared with, in rows: wind sensors average."""
WIND_SCALE = 0.2
"""By how much wind sensors and the flow around the mast make the wind follow the velocity otherwise. [1] Assumed."""
WIND_LABEL_COST = 5.5
"""Cost of a wrong label of the wind itself. [nats] Assumed, as of other channels."""
MOST_OF_WIND = 10.0
"""Most that the wind says against a reading: it turns of itself, too, and must not silence what position and heading
say, so it is less than UNEXPLAINED_COST. [nats] Assumed."""
THROUGHOUT = 0.75
"""Share of a log, by its parts, in which a reading must hold to count for the whole log. Assumed."""
UNLABELLED = 0.95
"""Such a share where both labels are compared, by the logarithms of their residuals in each part.
Drawn boats (tests/bench/mistakes, seeds 3000 to 3024): 1.00 in all 293 with a label that is wrong throughout; where it
is wrong in three quarters, 119 of 161 are below 0.95 and the rest above 0.98: there the last quarter does not tell."""
READING_SURE = 0.95
"""Probability above which a change is named."""
MOST_SURE = 0.998
"""Largest probability of a reading: what is not thought of remains."""
LEFT_OPEN = 0.5
"""Probability of something that no reading explains, above which nothing is reported."""
UNLIKELY_READING = 0.02
"""Probability below which a reading is not listed as an alternative."""
MOST_ALTERNATIVES = 6
"""Readings that are reported beside another."""

# Position against velocity, heading against rate

LONGEST_BRIDGE = 4.5
"""Usual steps across which a motion is integrated. Assumed."""
SLOW_MOTION = 4.0
"""Standard deviation of the bell over which noise and waves are averaged out. [s]"""
CLEAR_MOTION = 4.0
"""Slow motion over its noise, above which its size can be judged."""
NOISE_WINDOWS = 24
"""Windows of a log in which the noise is looked at."""
WHITENESS_LAGS = 12
"""Rows over which innovations may be correlated."""

# Labels of the navigation

LABEL_GAIN = 14.0
"""What a label must gain in its part over the log as labelled, correlated rows counted less. [nats]"""
SEGMENT_COST = 16.0
"""Cost of choosing both ends of a segment. [nats]"""
LABEL_CLIP = 5.0
"""Standard deviations beyond which an innovation counts no more."""
SHORTEST_LABEL = 60.0
"""Shortest segment; of a label of the navigation at most so much is asked. [s] Assumed."""
LABEL_ROWS = 60
"""Rows that make a segment long enough too: as many as SHORTEST_LABEL has in logs at 1 Hz, which it was set on."""
SHORTEST_WRONG = 10.0
"""Shortest segment of a label however close the rows are. [s] Assumed."""
RARE_LABEL = 6.5
"""Cost of a mistake above which it is not looked for in parts. [nats] Assumed: feet and miles, whose factors are near
those of knots and km/h."""
MOST_LABELS = 4
"""Mislabels of a part, of those that gain most, that are judged. Assumed."""
MOST_PARTS = 4
"""Parts of a log that are mislabelled. Assumed."""
CALM_PARTS = 0.8
"""Share of the windows of a log that its noise is taken from: a leap at an end of a part is in a few. With 0.6 a label
in 63 of 78 parts of three BlueBoat logs was named, with 0.8 in 64."""
NOISE_SHARE = 0.6
"""Quantile of the noise of windows that is the noise of the log; with 0.75, 61 of these 78."""
LABEL_REACH = 25
"""Rows on both sides in which an end of a segment is sought."""

# A yaw rate in rad/s

QUIET_GAIN = 60.0
"""What a stretch with so little noise must gain. [nats]"""
QUIETER = 0.2
"""Largest noise within such a stretch over the noise elsewhere; in rad/s it is 1/57."""
QUIET_CLIP = 4.0
"""Most that a row counts. [nats]"""
LIKELY_SIGNS = 0.3
"""Correlation of the signs of the rate with the rate of the heading; noise alone stayed below 0.2."""

# Labels of the wind

WIND_UNIT_GAIN = 5.0
"""What a unit of the whole log must gain, among three. [nats]"""
WIND_AVERAGING = 8.0
"""Standard deviation of the bell over the ship's velocity: wind sensors average, and waves shake the mast. [s]"""
WIND_SLOPE_NEAR = 0.3
"""Agreement of the slope of the wind on the ship's velocity."""
WIND_SLOPE_STD = 0.18
"""Largest standard deviation of that slope."""
BESIDE_SEGMENT = 240.0
"""Time beside an end of a segment, over which the wind is compared. [s]"""
WIND_JUMP = 0.35
"""Logarithm of the wind speed by which another unit may miss the jump at the ends of a segment."""
WIND_GOES_ON = 0.6
"""Share of the change of the wind over ground at the ends of a segment that may be left once it is corrected."""
STEADIER = 0.08
"""By which the steadiness of the wind must grow; so the ship must have turned."""

# Jumps of the wind

ABOVE_GUSTS = 1.2
"""Jumps at the ends of a part over the largest other change of the wind from row to row. At 1.0 gusts of a healthy drift
were taken for jumps; from 1.0 to 1.3 as many of 360 planted parts are found, 192 to 195 (trial's healthy logs)."""
BETWEEN_JUMPS = 60
"""Fewest rows between two jumps."""
JUMPS_GAIN = 11.0
"""What two jumps must gain. [nats] Set on nine logs of a model in gusts (ESSO Osaka), each with every and every tenth row:
none of 18 right winds is called wrong; of 108 planted parts 3 are right and none wrong."""
JUMPS_AT_ODDS = 5.0
"""What they gain by chance, for their probability. [nats] Assumed."""
JUMPS_TIED = 8.0
"""Within which jumps cannot tell labels apart. [nats]"""
STEADINESS_LAG = 30
"""Rows after which the wind over ground is compared with itself."""

# The clock by the channels alone

CLOCK_SLAB = 0.25
"""Prior standard deviation of ρ - 1, with ρ true seconds per logged second."""
SCALE_SLAB = {1: 0.03, 2: 0.1}
"""Prior standard deviation of a scale of the whole log, by number of axes: of the yaw rate, of the velocity."""
CLOCK_GAIN = 8.0
"""What a segment must gain after the cost of choosing it. [nats]"""
CLOCK_TOLERANCE = 0.05
"""Deviation of ρ from 1 below which the clock counts as right. Assumed."""
PLAUSIBLE_RATES = (0.65, 1.5)
"""ρ of a clock; noise alone, where a ship hardly moves, looks like a clock of a half."""
MOST_BLOCKS = 160
"""Most blocks of which segments consist."""
SHORTEST_BLOCK = 12.0
"""Shortest block. [s]"""
FEWEST_BLOCKS = 3
"""Fewest blocks of a segment."""
LARGEST_SHARE = 0.5
"""Largest share of the log; what is longer is a scale, not a segment."""
CLOCK_REACH = 30
"""Rows around the end of a segment in which it is sought."""
MOST_SEGMENTS = 4
"""Segments in one log. Assumed."""
CLOCK_CLIP = 25.0
"""Standard deviations beyond which an innovation counts no more."""
RATE_UNSURE = 0.03
"""Standard deviation of ρ from the ends of segments and the scale of the whole log. Assumed."""
ROUGHEST = 3.5
"""Innovations that are more correlated, after all that was found, say nothing about a clock."""

# Jumps of the position

JUMP_ROWS = (5, 10, 20)
"""Rows before and behind a place through which a line is laid: those that leave the least. Assumed."""
JUMP_OVER_USUAL = 6.0
"""Size of a jump over what nineteen in twenty places show. Of 22 logs of four craft without lost rows and 45 of a
simulator the largest was 5.1; in white noise it is fifteen standard deviations of an axis."""
JUMP_AT_ONCE = 0.6
"""Share of a jump that is made from one row to the next. Assumed."""
ON_HER_WAY = 0.9
"""Cosine of the angle between a jump and the velocity, above which rows were lost there. At 15 places of the logs of
two craft it was above 0.95."""
MOST_JUMPS = 6
"""Jumps of one log, above which its positions are rough throughout. Assumed."""

# Channels that come late

LAG_GAIN = 30.0
"""What a lag must gain over none, correlated rows counted less. [nats] Right logs of work, hold and trial, of both forms
(seeds 94000 to 94019), gain 16 at most."""
LARGEST_LAG = 15.0
"""Largest lag that is looked for. [s] Assumed."""
LAG_SPACING = 0.5
"""Distance of the lags that are tried, where rows are closer. [s]"""
SMALLEST_LAG = 1.5
"""Smallest lag that is reported. [s] Right logs of these seeds show 1.0 s at most."""
SMALLEST_LAG_ROWS = 1.5
"""The same in rows. Assumed."""

# Repair

HOLE = 1.5
"""Step over the usual one, above which rows are missing between."""
LONGEST_SPAN = 50.0
"""Span of a log over what its rows can fill, above which some of its stamps are wrong. Assumed."""
UNEVEN = 0.02
"""Spread of the steps as a share of the usual one, above which it is remarked; and median distance of the spans from
whole steps, in steps, above which the times of a log are uneven. Assumed."""
LATEST = 2.6e11
"""Latest time that is one, after the year 9999 counted from 1970. [s]"""
SHORTEST_STEP = 2e-4
"""Least usual time between rows, below which a unit is hardly right. Assumed. [s]"""
