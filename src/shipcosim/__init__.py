"""shipcosim: FMI co-simulation of ships, after the Open Simulation Platform's setup.

    import shipcosim as sc
    system = sc.read("my_ship.ssp")
    table = sc.simulate(system, stop_time=60.0)

Names are imported when they are first asked for, so that the command line starts quickly.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shipcosim.api import (
        Problem,
        Scenario,
        ShipcosimError,
        System,
        SystemStructure,
        judge,
        new,
        parameter,
        read,
        read_scenario,
        read_table,
        simulate,
        write_ssv,
        write_table,
    )
    from shipcosim.diagnose.pipeline import diagnose
    from shipcosim.fmi.export.builder import build_fmu
    from shipcosim.report import write_report

__version__ = "0.1.0"

__all__ = [
    "Problem",
    "Scenario",
    "ShipcosimError",
    "System",
    "SystemStructure",
    "build_fmu",
    "diagnose",
    "judge",
    "new",
    "parameter",
    "read",
    "read_scenario",
    "read_table",
    "simulate",
    "write_report",
    "write_ssv",
    "write_table",
]


def __getattr__(name):
    if name not in __all__:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    if name == "build_fmu":
        from shipcosim.fmi.export.builder import build_fmu as found
    elif name == "diagnose":
        import shipcosim.diagnose as found
    elif name == "write_report":
        from shipcosim.report import write_report as found
    else:
        from shipcosim import api

        found = getattr(api, name)
    globals()[name] = found
    return found


def __dir__():
    return sorted({*globals(), *__all__})
