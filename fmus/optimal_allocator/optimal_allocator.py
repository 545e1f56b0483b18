"""FMU of the optimal thrust allocator."""

from shipcosim.fmi import Parameters
from shipcosim.interfaces import NamedAllocator
from shipcosim.models.allocation import optimal


class OptimalAllocator(NamedAllocator):
    """Thrust allocation at the least power within all limits: two azimuth thrusters that turn and a tunnel thruster."""

    model = Parameters(optimal.OptimalParameters)
    law = optimal
