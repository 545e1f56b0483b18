"""Systems as WebAssembly, for pages that run them."""

from shipcosim.cosim.webassembly.module import Module, make_module

__all__ = ["Module", "make_module"]
