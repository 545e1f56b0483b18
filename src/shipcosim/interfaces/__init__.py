"""What FMUs of one kind share: their variables, so that one can take the other's place in a system."""

from shipcosim.interfaces.kinetic_predictor import KineticPredictor
from shipcosim.interfaces.named_allocator import NamedAllocator
from shipcosim.interfaces.numbered_allocator import NumberedAllocator, NumberedRequest
from shipcosim.interfaces.predictor import MotionPredictor
from shipcosim.interfaces.ship import Ship

__all__ = [
    "KineticPredictor",
    "MotionPredictor",
    "NamedAllocator",
    "NumberedAllocator",
    "NumberedRequest",
    "Ship",
]
