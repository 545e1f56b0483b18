"""Ships of the twin with numbers off within their tolerances, on one day and on another, for calibration."""

from functools import cache

from diagnose import twin

from shipcosim.diagnose.reference.calibration import calibrated_to, reference_of
from shipcosim.diagnose.reference.reference import ReferenceLog
from shipcosim.diagnose.reference.several_logs import SeveralLogs

HER_OWN = {
    "vessel.mass": 531e3 + 1.5 * 5310.0,
    "vessel.cross_flow_drag": 1.5 - 0.1,
    "port.azimuth_offset": 0.005,
    "tunnel.thrust_coefficient": 0.00683 + 0.0002,
}
SINCE = {"port.thrust_loss": 0.12}
CURRENT = {"water.current_north": 0.2, "water.current_east": -0.15}


@cache
def logs(seed):
    """By name, logs of the same ship on one day: well, with a loss since, and in a current."""
    return twin.sailed(
        {"well": HER_OWN, "lost": HER_OWN | SINCE, "current": HER_OWN | CURRENT}, seed=seed
    )


@cache
def problem(seed, name):
    """One of them as an identification problem."""
    return twin.ready(logs(seed)[name])


@cache
def calibration(name="well", seed=3):
    """Of the ship to one log."""
    return calibrated_to(SeveralLogs({name: problem(seed, name)}, is_well=True))


@cache
def reference(name="well", seed=3):
    """The reference of it."""
    found, log = calibration(name, seed), ReferenceLog(name=name, rows=361, span_s=(0.0, 360.0))
    ordinary = found.unmodelled[name]
    return reference_of(found, twin.model(), ordinary, [log], "gunnerus_open")
