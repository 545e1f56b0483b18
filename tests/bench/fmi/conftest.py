"""What the tests in fmi have at hand too."""

from fmi.conftest import build, compiled, lag, load, only_numpy, own_shipcosim, sources
