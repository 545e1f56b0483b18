"""Thresholds of calibration and of the diagnosis of several logs, each with its unit and what it was set on."""

CLOSE = 0.02
"""Share of its typical size by which a parameter may still move when a fit ends, as with one log."""
DAY_TO_DAY = 0.1
"""By what a number of the ship may differ from one day to the next, as a share of its tolerance. Assumed."""
NEGLIGIBLE = 0.02
"""Uncertainty along an axis of the reference, as a share of the tolerances, below which nothing is uncertain there."""
SCALES = (1.0, 1.5, 2.0, 3.0, 4.0)
"""Times the stated tolerances that are tried: the ship is known to be well, so what is beyond them is her own."""
WIDER = 3.0
"""Log-evidence that wider tolerances must gain to be believed. [nats] 20 to 1."""
WEATHER_GAIN = 20.0
"""What a current or a force of the day must gain beyond what any cause must, to be fitted beside a ship that is well:
instead of simulated healthy logs. [nats] Assumed."""
USUAL_FORM = 1.0
"""How far the form of a ship's loads differs from her model's unless her logs say otherwise by `FORM_COST` nats: as is
usual. [1] On developing ship 772 a reference of stationkeeping that took the model's form as certain made two causes of
a healthy working day."""
ORDINARY = 2.0
"""Times the gain of an unmodelled error in the logs of a reference, up to which it is no news: of 1.4 times the size.
Assumed."""
NOT_WELL = 100.0
"""Gain of a cause, or of an unmodelled error, beside the calibrated ship, above which the logs are refused. [nats] As
much as no healthy developing log came near."""
AT_EDGE = 3.0
"""Tolerances, as wide as the logs want them, beyond which a number is remarked upon."""
MOST_SUSPECTS = 4
"""Causes in the ship that are fitted beside the calibrated one, to see whether she is well."""
MOST_WEIGHT = 100.0
"""Information of a part of a log about a column, in units of its prior, above which more does not count more."""
BEYOND = 3.0
"""Standard deviations by which a number would have to leave its bounds for the logs to be refused. Assumed."""
SAME_RATIO = 0.01
"""Chance of as large a difference between logs of one ratio of thrust to inertia, below which they are said to
contradict each other. Assumed."""
APART = 2.5
"""Standard deviations by which a log's own ratio must be away from that of all others to be remarked upon. Assumed."""
MOST_PIECES = 24
"""Predictions of a log that are co-simulated, as many as for the gain of a single log."""
