"""shipcosim: FMI co-simulation of ships, after the Open Simulation Platform's setup.

    import shipcosim
    run = shipcosim.run("four_corner")
    found = shipcosim.diagnose("log.csv")

Names are imported when they are first asked for, so that the command line starts quickly.
"""

from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shipcosim.api import (
        Log,
        Problem,
        Run,
        Scenario,
        ShipcosimError,
        System,
        SystemStructure,
        calibrate,
        capability,
        check,
        compare,
        diagnose,
        judge,
        new,
        parameter,
        read,
        read_log,
        read_scenario,
        read_table,
        replay,
        run,
        sea_trials,
        simulate,
        simulate_many,
        sweep,
        write_ssv,
        write_table,
    )
    from shipcosim.fmi.export.builder import build_fmu
    from shipcosim.report import write_report

__version__ = "0.1.0"

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
    """A package whose name is also that of a function of `shipcosim.api`: the package can be called as the function."""

    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        return self.__wrapped__(*arguments, **keywords)

    @property
    def __wrapped__(self) -> Any:
        from shipcosim import api

        return getattr(api, self.__name__.rpartition(".")[2])


def __getattr__(name):
    if name not in __all__:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    if name == "build_fmu":
        from shipcosim.fmi.export.builder import build_fmu as found
    elif name == "capability":
        import shipcosim.capability as found
    elif name == "diagnose":
        import shipcosim.diagnose as found
    elif name == "sweep":
        import shipcosim.sweep as found
    elif name == "write_report":
        from shipcosim.report import write_report as found
    else:
        from shipcosim import api

        found = getattr(api, name)
    globals()[name] = found
    return found


def __dir__():
    return sorted({*globals(), *__all__})
