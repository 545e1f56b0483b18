"""FMU of the optimal thrust allocator of up to six units."""

from shipcosim.fmi import Parameters
from shipcosim.interfaces import NumberedAllocator
from shipcosim.models.allocation import optimal


class OptimalUnitsAllocator(NumberedAllocator):
    """Thrust allocation at the least power within all limits: up to six units, each fixed or turning."""

    model = Parameters(optimal.OptimalUnitsParameters)
    law = optimal
