"""Failures of a thruster, as FMEAs list them. Each is neutral by default."""

from typing import NamedTuple

from shipcosim.models.core.maths import Arithmetic

PLENTY = 1e8
"""Power so large that it does not limit a thruster. [W]"""


class Failures(NamedTuple):
    """Failures of a thruster. The default is a sound one.

    Parameters
    ----------
    stopped : bool or (...) array or tensor of bool
        Without power: no motor torque, the shaft runs free, the unit keeps its direction. [1]
    full_thrust : like stopped
        The drive gives its largest thrust ahead, whatever is commanded, as fast as the motor can. [1]
    rpm_frozen : like stopped
        The drive keeps its last set point of thrust. [1]
    azimuth_frozen : like stopped
        The unit keeps its direction. [1]
    rpm_reversed : like stopped
        The measured shaft speed has the wrong sign, for the drive and in the feedback. [1]
    azimuth_reversed : like stopped
        The measured direction has the wrong sign, for the steering and in the feedback. [1]
    rate_share : float or (...) array or tensor
        Share that is left of the largest rates of thrust and turning. [1]
    power_limit : like rate_share
        Power that the switchboard grants the motor. [W]

    References
    ----------
    Modes: the list of the project's requirements, after IMCA M 166, Guidance on failure modes and effects analyses;
    what each does to this drive is a definition.
    """

    stopped: Arithmetic = False
    full_thrust: Arithmetic = False
    rpm_frozen: Arithmetic = False
    azimuth_frozen: Arithmetic = False
    rpm_reversed: Arithmetic = False
    azimuth_reversed: Arithmetic = False
    rate_share: Arithmetic = 1.0
    power_limit: Arithmetic = PLENTY


SOUND = Failures()
"""Nothing has failed."""
