"""FMU of our neural thrust allocator for up to six units."""

from pathlib import Path

from shipcosim.fmi import Parameters
from shipcosim.interfaces import NumberedAllocator
from shipcosim.models.allocation import neural_allocator
from shipcosim.models.core.networks import read_arrays

WEIGHTS = Path(__file__).with_name("weights")


class NeuralUnitsAllocator(NumberedAllocator):
    """Thrust allocation by a trained network within all limits: four azimuth thrusters that know their slipstreams."""

    model = Parameters(neural_allocator.NeuralUnitsParameters)
    law = neural_allocator

    def designed(self):
        return neural_allocator.design(
            self.model, read_arrays(WEIGHTS / "neural-four-azimuths.npz")
        )
