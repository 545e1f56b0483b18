"""Where things are in a project, and what has to be built before a run."""

import tomllib
from pathlib import Path

import shipcosim
from shipcosim.errors import Problem, ShipcosimError, suggestion

SYSTEMS = (".ssp", ".ssd", ".xml")
IN_EVERY_FMU = ("models", "fmi")  # folders of this package whose code travels in FMUs


def find_project(start):
    """Nearest folder at or above a path that holds fmus/ or ssp/, or None."""
    start = Path(start).resolve()
    folders = [start, *start.parents]
    return next((f for f in folders if (f / "fmus").is_dir() or (f / "ssp").is_dir()), None)


def built_fmus(project):
    """Folder of a project's built FMUs."""
    return project / "build" / "fmus"


def find_scenario(given):
    """Scenario file: a path, or a name in the project's scenarios/.

    Raises
    ------
    ShipcosimError
        If there is none.
    """
    project = find_project(Path.cwd()) or Path.cwd()
    named = project / "scenarios" / f"{given}.toml"
    if Path(given).suffix.lower() in SYSTEMS and Path(given).exists():
        remedy = f"`shipcosim simulate {given}` runs it."
        raise ShipcosimError(Problem(given, "This is a system, not a scenario.", remedy))
    for path in (Path(given), named):
        if path.is_file():
            return path
    known = [path.stem for path in named.parent.glob("*.toml")]
    remedy = f"In {named.parent} there{suggestion(Path(given).stem, known).removeprefix('There')}"
    raise ShipcosimError(Problem(given, "There is no such scenario file.", remedy))


def check_is_system(given):
    """Raise ShipcosimError where what should be a system has the ending of something else."""
    suffix = Path(given).suffix.lower()
    if suffix == ".toml":
        remedy = f"If it is a scenario, `shipcosim run {given}` runs it."
        raise ShipcosimError(Problem(given, "This is no system.", remedy))
    if suffix == ".fmu":
        remedy = f"Connect it in a system (.ssp, .ssd). `shipcosim check {given}` says what is in it."
        raise ShipcosimError(Problem(given, "This is one FMU, not a system.", remedy))


def parsed_settings(settings):
    """Values of ``--set component.name=value``, each read as TOML; what is no TOML is text.

    Examples
    --------
    >>> parsed_settings(["vessel.mass=5e5", "port.failed=true", "environment.spectrum=kaimal"])
    {'vessel.mass': 500000.0, 'port.failed': True, 'environment.spectrum': 'kaimal'}
    """
    values, problems = {}, []
    for setting in settings:
        name, sign, text = setting.partition("=")
        if not sign or not name.strip():
            problems.append(Problem("--set", f"'{setting}' sets nothing.", "Right would be component.name=value."))
        values[name.strip()] = _parsed(text.strip())
    if problems:
        raise ShipcosimError(problems)
    return values


def _parsed(text):
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        return text


def build_named(project, names, out, progress=None):
    """Build FMUs and pack systems.

    Parameters
    ----------
    project : Path
        With fmus/ and ssp/.
    names : collection of str
        Of FMUs and systems; all if empty.
    out : Path
        Gets fmus/ and ssp/.
    progress : callable, optional
        Called with (done, in all).

    Returns
    -------
    list of Path
        What was built.

    Raises
    ------
    ShipcosimError
        With all problems; what has none is built nevertheless.
    """
    fmus, systems = _fmus(project), _systems(project)
    known = [*fmus, *systems]
    problems = [Problem(n, "There is no such FMU or system.", suggestion(n, known)) for n in names if n not in known]
    jobs = [(_build, path, out) for name, path in fmus.items() if not names or name in names]
    jobs += [(_pack, path, out) for name, path in systems.items() if not names or name in names]
    built = []
    for done, (job, path, target) in enumerate(jobs, start=1):
        try:
            built.append(job(path, target))
        except ShipcosimError as error:
            problems += error.problems
        if progress:
            progress(done, len(jobs))
    if problems:
        raise ShipcosimError(problems)
    return built


def build_stale(project):
    """Build the project's FMUs that are missing or older than what goes into them.

    Parameters
    ----------
    project : Path
        With fmus/.

    Returns
    -------
    Path
        Folder with the FMUs.
    """
    package = Path(shipcosim.__file__).parent
    shared = max(_newest(package / room) for room in IN_EVERY_FMU)
    for name, folder in _fmus(project).items():
        fmu = built_fmus(project) / f"{name}.fmu"
        if not fmu.is_file() or fmu.stat().st_mtime < max(shared, _newest(folder)):
            _build(folder, project / "build")
    return built_fmus(project)


def experiment_of(system, stop_time=None, step_size=None):
    """Scenario in which nothing happens, for as long and in such steps as asked for or as the system says.

    Raises
    ------
    ShipcosimError
        If neither says it, or the two do not fit together.
    """
    from shipcosim.scenario import Scenario, check_times

    stop = stop_time if stop_time is not None else system.experiment.stop_time
    step = step_size if step_size is not None else system.experiment.step_size
    problems = [
        Problem(option, f"{value} is no {what}.", f"Give {option} in seconds, greater than 0.")
        for option, value, what in (("--stop-time", stop, "stop time"), ("--step-size", step, "step size"))
        if value is None or not value > 0.0
    ]
    if not problems:
        scenario = Scenario(description=f"Simulation of {system.name}", stop_time=stop, step_size=step)
        problems = [Problem("--stop-time, --step-size", p.found, p.remedy) for p in check_times(scenario)]
    if problems:
        raise ShipcosimError(problems)
    return scenario


def with_osp_events(scenario, path, start_time=0.0):
    """Scenario in which, besides, happens what a file of OSP says; the same without a path. Remarks are printed.

    Parameters
    ----------
    scenario : Scenario
        Its steps are the run's.
    path : Path or None
        Of the file.
    start_time : float
        Of the run. [s]
    """
    if path is None:
        return scenario
    from shipcosim.cli.console import print_problems
    from shipcosim.scenario.osp import read_osp_scenario

    read = read_osp_scenario(path, scenario.step_size, scenario.stop_time, start_time)
    print_problems(read.remarks)
    more = {"events": [*scenario.events, *read.events]}
    return scenario.model_copy(update=more | ({"description": read.description} if read.description else {}))


def feeding(path, system, interpolated, max_gap):
    """Table that feeds a system's inputs, or None without a path.

    Parameters
    ----------
    path : Path or None
        Of a table.
    system : System
        With the inputs.
    interpolated : collection of str
        Columns, or patterns of them, that change linearly between their rows.
    max_gap : float or None
        Longest time between two rows. [s]

    Raises
    ------
    ShipcosimError
        If there is no such file or column, or no table for these options.
    """
    if path is None:
        if interpolated or max_gap is not None:
            found = "There is no table that this could be about."
            raise ShipcosimError(Problem("--interpolate, --max-gap", found, "Give one with --inputs."))
        return None
    from shipcosim.cosim import interpolated as marked
    from shipcosim.series import read_table

    table = marked(read_table(path), system, interpolated)
    return table if max_gap is None else table.assign_attrs(max_gap=max_gap)


def _fmus(project):
    """Folders of FMUs by name, in the order of their names."""
    return {f.name: f for f in sorted((project / "fmus").glob("*")) if (f / f"{f.name}.py").is_file()}


def _systems(project):
    return {f.name: f for f in sorted((project / "ssp").glob("*")) if (f / "SystemStructure.ssd").is_file()}


def _build(folder, out):
    from shipcosim.fmi.export.builder import build_fmu

    return build_fmu(folder, out / "fmus")


def _pack(folder, out):
    from shipcosim.ssp import pack

    target = out / "ssp" / f"{folder.name}.ssp"
    pack(folder, [out / "fmus"], target)
    return target


def _newest(folder):
    return max((path.stat().st_mtime for path in folder.rglob("*") if path.suffix != ".pyc"), default=0.0)
