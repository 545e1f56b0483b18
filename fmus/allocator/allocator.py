"""FMU of the thrust allocator."""

from shipcosim.fmi import Parameters
from shipcosim.interfaces import NamedAllocator
from shipcosim.models.allocation import pseudo_inverse


class Allocator(NamedAllocator):
    """Thrust allocation by generalised inverse: two azimuth thrusters at fixed angles and a tunnel thruster."""

    model = Parameters(pseudo_inverse.AllocationParameters)
    law = pseudo_inverse
