"""A local server that steps a system which no page can run itself, and the page that steers it."""

from shipcosim.live.run import LiveRun
from shipcosim.live.server import LiveServer

__all__ = ["LiveRun", "LiveServer"]
