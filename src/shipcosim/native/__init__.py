"""Compiled models: the step of a component is recorded on symbols, written as C and compiled."""

from shipcosim.native.compiler import check_installed, is_installed, libraries
from shipcosim.native.component import CompiledStep, compiled_steps
from shipcosim.native.symbols import Untraceable

__all__ = [
    "CompiledStep",
    "Untraceable",
    "check_installed",
    "compiled_steps",
    "is_installed",
    "libraries",
]
