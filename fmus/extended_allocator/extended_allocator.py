"""FMU of a thrust allocator that turns the azimuth thrusters."""

from shipcosim.fmi import Parameters
from shipcosim.interfaces import NamedAllocator
from shipcosim.models.allocation import extended


class ExtendedAllocator(NamedAllocator):
    """Thrust allocation by generalised inverse over rectangular force components: azimuths that turn, and a tunnel."""

    model = Parameters(extended.ExtendedParameters)
    law = extended
    turns = True
