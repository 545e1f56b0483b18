"""FMU of a thrust allocator of up to six units at fixed directions."""

from shipcosim.fmi import Parameters
from shipcosim.interfaces import NumberedAllocator
from shipcosim.models.allocation import fixed_angles


class FixedAngleAllocator(NumberedAllocator):
    """Thrust allocation by generalised inverse: up to six units, each at a fixed direction."""

    model = Parameters(fixed_angles.FixedAngleParameters)
    law = fixed_angles
    turns = False
