"""What becomes of each feature in each engine, found by running it: right, refused, silently wrong, crashes or hangs.

`record` runs every case on an engine in a process of its own, which may die of it; write_interoperability.py in docs/
makes the page from what it returns. As a script this is that process: NAME of the engine, FOLDER, then cases.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

if __name__ == "__main__":
    sys.path[:0] = [
        str(Path(__file__).resolve().parents[1]),
        str(Path(__file__).resolve().parents[2]),
    ]

import numpy as np
from conformance.cases import cases, documents, write
from conformance.fmus import fmu_of

import shipcosim as sc
from shipcosim.ssp import read_fmu, read_system

LIMIT = 60.0  # s, for one case
FORMED = {
    "form_folder": ("Packaging", "folder instead of an archive", "folder, 1.0"),
    "form_prefixes": ("Packaging", "other namespace prefixes", "ssp, 1.0, other prefixes"),
    "form_2": ("Packaging", "SSP 2.0", "ssp, 2.0"),
}
"""Rows of the table for ways to write down a system, tried with the plainest case: group, feature and form."""
RIGHT, REFUSED, WRONG, CRASHES, HANGS = (
    "right",
    "refused",
    "*silently wrong*",
    "**crashes**",
    "**hangs**",
)


def rows():
    """(group, feature, about) by name: of every case, and of the forms."""
    forms = {name: (group, feature, "") for name, (group, feature, _) in FORMED.items()}
    return {name: (case.group, case.feature, case.about) for name, case in cases().items()} | forms


def record(engine, names=None):
    """Verdicts of an engine by case.

    Parameters
    ----------
    engine : str
        A key of ENGINES.
    names : iterable of str, optional
        Which rows; all if not given.

    Returns
    -------
    dict of str to (str, str)
        Verdict and, where the engine said something, what.
    """
    left, found = list(rows() if names is None else names), {}
    with tempfile.TemporaryDirectory(prefix="conformance-") as folder:
        while left:
            said, ending = _worked(engine, folder, left)
            found |= said
            left = [name for name in left if name not in said]
            if left and ending:
                found[left.pop(0)] = ending
    return found


def _worked(engine, folder, names):
    """Verdicts that a process gave until it ended, and what that makes of the case after those."""
    command = [sys.executable, str(Path(__file__).resolve()), engine, folder, *names]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    said, ending = {}, (CRASHES, "")
    os.set_blocking(process.stdout.fileno(), True)
    try:
        output, _ = process.communicate(timeout=LIMIT * (1 + len(names) / 20))
    except subprocess.TimeoutExpired as expired:
        process.kill()
        output = (expired.stdout or b"").decode() + (process.communicate()[0] or "")
        ending = HANGS, ""
    for line in output.splitlines():
        with suppress(ValueError):
            name, verdict, detail = json.loads(line)
            said[name] = verdict, detail
    return said, ending


# the process


def main(engine, folder, *names):
    """Run cases and print a line for each."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # engines print what they like
    for name in names:
        case = cases()["connection" if name in FORMED else name]
        form = (
            FORMED[name][2]
            if name in FORMED
            else "ssp, 1.0"
            if "1.0" in case.versions
            else "ssp, 2.0"
        )
        path = write(case, Path(folder) / f"{engine}-{name}-{os.getpid()}", form)
        verdict = _verdict(ENGINES[engine], case, path)
        print(json.dumps([name, *verdict]), file=out, flush=True)
    os._exit(0)  # some cannot be ended in order


def _verdict(run, case, path):
    try:
        values = run(case, path)
    except Exception as error:
        return REFUSED, (str(error).strip() or type(error).__name__).splitlines()[0][:200]
    wrong = [name for name in case.expect if not _is_right(case, name, values.get(name))]
    return (WRONG, f"{wrong[0]} is {values.get(wrong[0])}") if wrong else (RIGHT, "")


def _is_right(case, signal, value):
    wanted = case.closed_form(signal)[-1]
    if value is None or isinstance(wanted, str):
        return value in (wanted, str(wanted).encode())
    return bool(
        np.isclose(
            float(value), float(wanted), rtol=(limit := max(1e-9, case.tolerance)), atol=limit
        )
    )


def _through(engine):
    def run(case, path):
        table = sc.simulate(str(path), engine=engine, **case.keywords())
        if not np.allclose(table["time"].values, case.times()):
            return {}
        if missing := [signal for signal in case.expect if signal not in table]:
            raise RuntimeError(f"the table has no {', '.join(missing)}")
        return {signal: table[signal].values[-1].item() for signal in case.expect}

    return run


def _ends(case, path):
    """(signal, component, variable) of what is expected, as we read the system."""
    system = None if case.gap else read_system(path)
    for signal in case.expect:
        component, variable = signal.split(".") if case.gap else system.split(signal)
        fmu = (
            read_fmu(fmu_of(*next(iter(case.fmus.items()))))
            if case.gap
            else system.components[component].fmu
        )
        yield signal, component, fmu.variables[variable]


def _steps(case):
    """Step size and number of steps, where an engine has to be told."""
    return case.run.get("step_size", case.step_size), len(case.times()) - 1


def in_libcosim(case, path):
    """libcosim reading the SSP itself; it is told the step size where the case says that the file does not."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    ends = list(_ends(case, path))
    step, n_steps = _steps(case)
    given = () if "step_size" in case.run else (round(step * 1e9),)
    execution = CosimExecution.from_ssp_file(str(path), *given)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    for _ in range(n_steps):
        if not execution.step():
            raise RuntimeError("a step failed")
    if abs(execution.status().current_time * 1e-9 - case.times()[-1]) > 1e-9:
        return {}
    last = {
        "Real": observer.last_real_values,
        "Integer": observer.last_integer_values,
        "Enumeration": observer.last_integer_values,
        "Boolean": observer.last_boolean_values,
        "String": observer.last_string_values,
    }
    values = {}
    for signal, component, variable in ends:
        slave = execution.slave_index_from_instance_name(component)
        if slave is not None:
            values[signal] = last[variable.kind](slave, [variable.value_reference])[0]
    return values


def in_ecos(case, path):
    """ecos reading the SSP itself; it is told the parameter set and a step size: half of it where the file says one."""
    from ecospy import EcosLib, EcosSimulation

    EcosLib.set_log_level("off")
    ends = list(_ends(case, path))
    step, n_steps = _steps(case)
    split = 2 if "step_size" in case.run else 1
    simulation = EcosSimulation(ssp_path=str(path), step_size=step / split)
    sets = re.findall(r'<ssv:ParameterSet [^>]*name="([^"]*)"', "".join(documents(case).values()))
    if not (simulation.init(parameter_set=sets[-1]) if sets else simulation.init()):
        raise RuntimeError(EcosLib.get_last_error())
    for _ in range(n_steps * split):
        simulation.step()
    if abs(simulation.get_time() - case.times()[-1]) > 1e-9:
        return {}
    get = {
        "Real": simulation.get_real,
        "Integer": simulation.get_integer,
        "Boolean": simulation.get_bool,
    }
    get |= {"Enumeration": simulation.get_integer, "String": simulation.get_string}
    return {signal: get[v.kind](f"{component}::{v.name}") for signal, component, v in ends}


def in_fmpy(case, path):
    """FMPy's simulate_ssp; values are read from the FMUs at the end, since it records connectors alone."""
    import fmpy.ssp.simulation as simulation

    ends = list(_ends(case, path))
    values, free = {}, simulation.free_fmu

    def read_and_free(component):
        full, system = component.name, component.parent
        while system.parent is not None:
            full, system = f"{system.name}.{full}", system.parent
        for signal, name, variable in ends:
            if name == full:
                values[signal] = simulation.get_value(component, variable.name)
        free(component)

    simulation.free_fmu = read_and_free
    step = {} if "step_size" in case.run else {"step_size": case.step_size}
    stop = {} if "stop_time" in case.run else {"stop_time": case.stop_time}
    try:
        simulation.simulate_ssp(str(path), **step, **stop)
    finally:
        simulation.free_fmu = free
    return values


ENGINES = {
    "shipcosim": _through("fmpy"),
    "shipcosim on libcosim": _through("libcosim"),
    "shipcosim on ecos": _through("ecos"),
    "libcosim": in_libcosim,
    "ecos": in_ecos,
    "FMPy": in_fmpy,
}

if __name__ == "__main__":
    main(*sys.argv[1:])
