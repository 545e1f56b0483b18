"""FMU of the neural allocator of paper V."""

from pathlib import Path

from shipcosim.fmi import FmuError, Parameter, Parameters
from shipcosim.interfaces import NamedAllocator
from shipcosim.models.allocation import paper_v
from shipcosim.models.core.networks import read_arrays

WEIGHTS = Path(__file__).with_name("weights")


class PaperVAllocator(NamedAllocator):
    """Thrust allocation by the neural network of paper V, as printed: nothing holds it to its limits."""

    variant = Parameter(
        "paper-v", "1", "which training: the name of a file of weights", origin="choice"
    )
    model = Parameters(paper_v.PaperVParameters)
    law = paper_v

    def designed(self):
        known = sorted(file.stem for file in WEIGHTS.glob("*.npz"))
        if self.variant not in known:
            raise FmuError(
                f"variant '{self.variant}': there is none. There are {', '.join(known)}."
            )
        return paper_v.design(read_arrays(WEIGHTS / f"{self.variant}.npz"))
