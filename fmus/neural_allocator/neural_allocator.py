"""FMU of our neural thrust allocator."""

from pathlib import Path

from shipcosim.fmi import Parameters
from shipcosim.interfaces import NamedAllocator
from shipcosim.models.allocation import neural_allocator
from shipcosim.models.core.networks import read_arrays

WEIGHTS = Path(__file__).with_name("weights")


class NeuralAllocator(NamedAllocator):
    """Thrust allocation by a trained network within all limits: two azimuth thrusters and a tunnel, of R/V Gunnerus."""

    model = Parameters(neural_allocator.NeuralParameters)
    law = neural_allocator
    turns = True

    def designed(self):
        name = "neural-slipstreams" if self.model.azimuth_diameter > 0.0 else "neural"
        return neural_allocator.design(self.model, read_arrays(WEIGHTS / f"{name}.npz"))
