"""Writing FMUs: declare variables on a class, write `step`, and `shipcosim.fmi.export.builder` packs it.

What is named here travels inside every FMU, so it needs Python alone. The folder `export` stays behind.
"""

from shipcosim.fmi.failures import FmuError
from shipcosim.fmi.fmu import Fmu
from shipcosim.fmi.variables import Input, Output, Parameter, Parameters, Variable

__all__ = ["Fmu", "FmuError", "Input", "Output", "Parameter", "Parameters", "Variable"]
