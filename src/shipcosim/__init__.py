"""shipcosim: FMI co-simulation of ships, after the Open Simulation Platform's setup.

    import shipcosim as sc
    system = sc.read("ssp/gunnerus_dp")
    table = sc.simulate(system, stop_time=60.0)

Nothing is imported before it is asked for, and by name (`import_module`), so that FMUs, which carry this file, do not
carry the rest of the package.
"""

from importlib import import_module

__version__ = "0.1.0"

__all__ = [
    "Problem",
    "Scenario",
    "ShipcosimError",
    "System",
    "SystemStructure",
    "build_fmu",
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
_HOMES = {
    "errors": ("Problem", "ShipcosimError"),
    "fmi.builder": ("build_fmu",),
    "report": ("write_report",),
    "scenario": ("Scenario", "judge", "read_scenario"),
    "series": ("read_table", "write_table"),
    "ssp": ("System", "SystemStructure", "new", "parameter", "read", "write_ssv"),
}


def simulate(
    system=None,
    scenario=None,
    *,
    stop_time=None,
    step_size=None,
    output_interval=None,
    set=None,
    events=(),
    engine="fmpy",
    inputs=None,
    progress=None,
    order="jacobi",
    start_time=None,
    until=None,
    resume=None,
    store=None,
    isolate=False,
    timeout=60.0,
):
    """Run a system and return the table of all signals.

    Parameters
    ----------
    system : SystemStructure, System or path, optional
        What runs; the scenario's system if not given.
    scenario : Scenario or path, optional
        What happens; the keywords add to it and go before it.
    stop_time, step_size, output_interval : float, optional
        Where nobody says anything, the system's default experiment does, and every step is a row. [s]
    set : mapping of str to value, optional
        Start values by full name, in the FMUs' units.
    events : iterable of mapping
        As in a scenario file: ``{"time": 10.0, "override": {"vessel.tau_X_5": 1e4}}``.
    start_time : float, optional
        As for `shipcosim.cosim.simulate`; where nobody says anything, the system's default experiment does. [s]
    engine, inputs, progress, order, until, resume, store, isolate, timeout
        As for `shipcosim.cosim.simulate`: `until` and `store` stop at a time and keep the state of the whole system,
        `resume` continues from there; `isolate` has each component run in a process of its own.

    Returns
    -------
    Dataset
        One row per output interval, `time` in s; variables are named ``component.connector``.

    Raises
    ------
    ShipcosimError
        If something does not fit together, or the run fails.
    """
    ssp, scenarios, cosim = (import_module(f"{__name__}.{room}") for room in ("ssp", "scenario", "cosim"))
    if scenario is not None and not isinstance(scenario, scenarios.Scenario):
        scenario = scenarios.read_scenario(scenario)
    if system is None:
        system = scenario.system_path if scenario is not None else _missing("system", "Give a system or a scenario.")
    if not isinstance(system, ssp.System):
        parameters = () if scenario is None else scenario.parameter_paths
        if not isinstance(system, ssp.SystemStructure) and ssp.osp_file(system):
            system = ssp.read_system(system, parameters)
        else:
            structure = system if isinstance(system, ssp.SystemStructure) else ssp.read(system)
            system = structure.checked(parameters)
    if start_time is None:
        start_time = system.experiment.start_time if scenario is None and resume is None else 0.0
    keys = {"stop_time": stop_time, "step_size": step_size, "output_interval": output_interval}
    keys = {name: value for name, value in keys.items() if value is not None}
    scenario = _scenario(scenario, system.experiment, keys | {"set": set or {}, "events": list(events)})
    course = {"order": order, "start_time": start_time, "until": until, "resume": resume, "store": store}
    course |= {"isolate": isolate, "timeout": timeout}
    return cosim.simulate(system, scenario, engine=engine, inputs=inputs, progress=progress, **course)


def _scenario(given, experiment, keys):
    """Scenario of keys, over those of another one or over the system's default experiment; checked."""
    scenarios, errors = import_module(f"{__name__}.scenario"), import_module(f"{__name__}.errors")
    if given is None:
        default = {"stop_time": experiment.stop_time, "step_size": experiment.step_size}
        keys = {name: value for name, value in default.items() if value is not None} | keys
    else:
        had = given.model_dump(exclude_defaults=True)
        keys["set"] = had.get("set", {}) | keys["set"]
        keys["events"] = [*had.get("events", ()), *keys["events"]]
        keys = had | keys
    try:
        scenario = scenarios.Scenario.model_validate(keys)
    except ValueError as error:  # pydantic's
        raise errors.ShipcosimError([_problem(finding) for finding in error.errors()]) from None
    problems = [problem for problem in scenarios.check_times(scenario) if problem.severity == "error"]
    if problems:
        raise errors.ShipcosimError(problems)
    return scenario if given is None else given.model_copy(update={name: getattr(scenario, name) for name in keys})


def _missing(name, remedy):
    errors = import_module(f"{__name__}.errors")
    raise errors.ShipcosimError(errors.Problem("simulate", f"{name} is missing.", remedy))


def _problem(finding):
    """One of pydantic's findings in our words."""
    errors = import_module(f"{__name__}.errors")
    name = ".".join(map(str, finding["loc"]))
    if finding["type"] == "missing":
        return errors.Problem("simulate", f"{name} is missing.", "Give it in s: the system has no default.")
    text = finding["msg"].removeprefix("Value error, ").removesuffix(".")
    return errors.Problem("simulate", f"{name} = {finding['input']!r}.", f"{text}.")


def __getattr__(name):
    for home, names in _HOMES.items():
        if name in names:
            value = globals()[name] = getattr(import_module(f"{__name__}.{home}"), name)
            return value
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__():
    return sorted({*globals(), *__all__})
