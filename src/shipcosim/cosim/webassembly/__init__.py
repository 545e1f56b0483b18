"""Systems as WebAssembly, for pages that run them."""

from shipcosim.cosim.webassembly.module import make_module
from shipcosim.cosim.webassembly.wiring import MOST_STEPS, NotForPages

__all__ = ["MOST_STEPS", "NotForPages", "make_module"]
