"""shipcosim: FMI co-simulation of ships, after the Open Simulation Platform's setup.

    import shipcosim
    run = shipcosim.run("four_corner")
    found = shipcosim.diagnose("log.csv")

Names are imported when they are first asked for, so that the command line starts quickly.
"""

from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shipcosim.calls.arguments import read_scenario
    from shipcosim.calls.logs import calibrate, diagnose, read_log, replay, sea_trials
    from shipcosim.calls.reports import report
    from shipcosim.calls.runs import run, simulate
    from shipcosim.calls.studies import sweep
    from shipcosim.calls.systems import capability, check, compare, read
    from shipcosim.calls.variations import simulate_many
    from shipcosim.errors import Problem, ShipcosimError
    from shipcosim.fmi.export.builder import build_fmu
    from shipcosim.report import write_report
    from shipcosim.results.log import Log
    from shipcosim.results.run import Run
    from shipcosim.scenario import Scenario, judge
    from shipcosim.series import read_table, write_table
    from shipcosim.ssp import System, SystemStructure, new, parameter, write_ssv

__version__ = "0.2.0"

__all__ = [
    "Log",
    "Problem",
    "Run",
    "Scenario",
    "ShipcosimError",
    "System",
    "SystemStructure",
    "build_fmu",
    "calibrate",
    "capability",
    "check",
    "compare",
    "diagnose",
    "judge",
    "new",
    "parameter",
    "read",
    "read_log",
    "read_scenario",
    "read_table",
    "replay",
    "report",
    "run",
    "sea_trials",
    "simulate",
    "simulate_many",
    "sweep",
    "write_report",
    "write_ssv",
    "write_table",
]


class CallableRoom(ModuleType):
    """A package whose name is also that of a function of `shipcosim.calls`: it can be called as the function."""

    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        return self.__wrapped__(*arguments, **keywords)

    @property
    def __wrapped__(self) -> Any:
        name = self.__name__.rpartition(".")[2]
        return getattr(_place_of(name), name)


def _place_of(name: str) -> ModuleType:
    """The module of a public name; each is imported when it is first asked for."""
    if name in ("run", "simulate"):
        from shipcosim.calls import runs as place
    elif name in ("calibrate", "diagnose", "read_log", "replay", "sea_trials"):
        from shipcosim.calls import logs as place
    elif name in ("capability", "check", "compare", "read"):
        from shipcosim.calls import systems as place
    elif name == "sweep":
        from shipcosim.calls import studies as place
    elif name == "report":
        from shipcosim.calls import reports as place
    elif name == "simulate_many":
        from shipcosim.calls import variations as place
    elif name == "read_scenario":
        from shipcosim.calls import arguments as place
    elif name in ("Problem", "ShipcosimError"):
        from shipcosim import errors as place
    elif name in ("Scenario", "judge"):
        from shipcosim import scenario as place
    elif name in ("read_table", "write_table"):
        from shipcosim import series as place
    elif name in ("System", "SystemStructure", "new", "parameter", "write_ssv"):
        from shipcosim import ssp as place
    elif name == "Log":
        from shipcosim.results import log as place
    elif name == "Run":
        from shipcosim.results import run as place
    elif name == "build_fmu":
        from shipcosim.fmi.export import builder as place
    else:
        from shipcosim import report as place
    return place


def __getattr__(name):
    if name not in __all__:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    if name == "capability":
        import shipcosim.capability as attribute
    elif name == "diagnose":
        import shipcosim.diagnose as attribute
    elif name == "report":
        import shipcosim.report as attribute
    elif name == "sweep":
        import shipcosim.sweep as attribute
    else:
        attribute = getattr(_place_of(name), name)
    if isinstance(attribute, FunctionType) and not hasattr(attribute, "__wrapped__"):
        from shipcosim.keywords import with_known_keywords

        attribute = with_known_keywords(attribute)
    globals()[name] = attribute
    return attribute


def __dir__():
    return sorted([*__all__, "__version__"])
