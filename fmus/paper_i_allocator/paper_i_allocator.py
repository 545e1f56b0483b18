"""FMU of the neural allocators of paper I."""

from pathlib import Path

from shipcosim.fmi import FmuError, Output, Parameter, Parameters
from shipcosim.interfaces import NumberedAllocator
from shipcosim.models.allocation import extreme_learning
from shipcosim.models.core.networks import read_arrays

WEIGHTS = Path(__file__).with_name("weights")


class PaperIAllocator(NumberedAllocator):
    """Thrust allocation by the extreme learning machines of paper I, as printed: nothing holds them to limits."""

    command_1 = Output(
        "1", "command of unit 1 as the network gives it, in the unit of its training: rpm"
    )
    command_2 = Output("1", "the same of unit 2, rpm")
    command_3 = Output("1", "the same of unit 3, rpm")
    command_4 = Output("1", "the same of unit 4, rpm")
    command_5 = Output("1", "the same of unit 5, deg of pitch")
    command_6 = Output("1", "the same of unit 6, deg of pitch")

    variant = Parameter(
        "paper-i", "1", "which training: the name of a file of weights", origin="choice"
    )
    model = Parameters(extreme_learning.ExtremeLearningParameters)
    law = extreme_learning

    def designed(self):
        known = sorted(file.stem for file in WEIGHTS.glob("*.npz"))
        if self.variant not in known:
            raise FmuError(
                f"variant '{self.variant}': there is none. There are {', '.join(known)}."
            )
        return extreme_learning.network_of(read_arrays(WEIGHTS / f"{self.variant}.npz"), self.model)

    def _show(self, state):
        super()._show(state)
        self.command_1, self.command_2, self.command_3 = state.commands[:3]
        self.command_4, self.command_5, self.command_6 = state.commands[3:]
