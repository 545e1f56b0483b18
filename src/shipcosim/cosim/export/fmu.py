"""Export a system as one FMU, after comparing it with the system itself.

The container passes connections on once at the start, where our master repeats it until nothing changes any more; and
an FMU may put out something else as soon as it gets an input. Neither can be seen in files. So both are run for some
steps, with more passes in the container where it needs them, and an FMU that computes something else is not written.
"""

import os
from pathlib import Path

import numpy as np

from shipcosim.cosim.export.container import write_container
from shipcosim.cosim.master.run import run
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component, System, read_fmu
from shipcosim.temporary import temporary_folder

SWEEPS = (1, 2, 4, 8)
STEPS = 100
LIMIT = 60.0
"""How long the container, in a process of its own, may take for an answer: its library ends the process where an FMU in
it cannot be instantiated. [s]"""
TOLERANCE = 1e-9
"""Largest difference, over the largest value of the signals of a component in one unit: what is left of two forces is
as exact as they are. Times are rounded differently in the last digit inside the container."""


def export_fmu(
    system: System,
    path: str | os.PathLike,
    step_size: float,
    *,
    connectors_only: bool = False,
    check: bool = True,
) -> list[Problem]:
    """Write a system as one FMU of FMI 2.0 co-simulation.

    Parameters
    ----------
    system : System
        As read.
    path : path
        Of the FMU.
    step_size : float
        Of the exchange inside. [s]
    connectors_only : bool
        Whether the FMU shows the system's own connectors alone. Otherwise it also shows, named as in the table of a
        run, the outputs and parameters of all components and the inputs that nothing feeds.
    check : bool
        Whether to run FMU and system side by side first, which runs the code of all FMUs.

    Returns
    -------
    list of Problem
        Remarks on what the FMU does not show.

    Raises
    ------
    ShipcosimError
        With everything that the FMU could not express, or with the signals in which it differs.
    """
    if not check:
        return write_container(system, Path(path), step_size, connectors_only=connectors_only)
    # Our own run is the reference. It is made only once.
    ours = None
    differing = []
    with temporary_folder() as folder:
        # Try as few sweeps as possible: each costs time at every step of the FMU.
        for sweeps in SWEEPS:
            tried = Path(folder) / f"{sweeps}.fmu"
            remarks = write_container(
                system, tried, step_size, connectors_only=connectors_only, sweeps=sweeps
            )
            ours = _run(system, step_size, RunOptions()) if ours is None else ours
            # The container runs in a process of its own, because an FMU in it may end the process.
            container = _run(block_of(tried), step_size, RunOptions(isolate=True, timeout=LIMIT))
            differing = _differences(ours, container)
            if not differing:
                # Write to the target only what has passed the comparison.
                write_container(
                    system, Path(path), step_size, connectors_only=connectors_only, sweeps=sweeps
                )
                return remarks
    remedy = (
        "There, components whose outputs follow their inputs at once are in another order. If only last digits differ, "
        "a component amplifies rounding: the FMU can then be written without this comparison."
    )
    raise ShipcosimError([Problem(system.name, text, remedy) for text in differing[:5]])


def block_of(fmu: Path) -> System:
    """A system with an FMU as its only component, called ``block``."""
    return System("block", str(fmu), {"block": Component("block", read_fmu(fmu))})


def _run(system, step_size, options):
    scenario = Scenario(
        description="side by side", step_size=step_size, stop_time=STEPS * step_size
    )
    return run(system, scenario, options)


def _differences(ours, theirs):
    """Describe the outputs of the container that differ from the system's, the worst first."""
    differing = []
    scales = _scales(ours)
    # Texts cannot be compared by size; the container passes them on unchanged.
    for name in theirs.data_vars:
        shown = name.removeprefix("block.")
        if shown not in ours or theirs[name].dtype.kind not in "fbi":
            continue
        a = ours[shown].values.astype(float)
        b = theirs[name].values.astype(float)
        error = np.abs(a - b)
        # The error is relative to the largest signal of the same unit in the component: a small
        # difference of two large forces is no more exact than they are.
        scale = max(scales[_kind(ours, shown)], np.abs(b).max(), 1e-9)
        if error.max() > TOLERANCE * scale:
            row = int(error.argmax())
            time = float(ours["time"][row])
            differing.append(
                (
                    error.max() / scale,
                    f"{shown} is {a[row]:.9g} at t = {time:g} s, in the FMU {b[row]:.9g}.",
                )
            )
    return [text for _, text in sorted(differing, reverse=True)]


def _scales(table):
    """Largest absolute value among the signals of each component in each unit."""
    scales = {}
    for name in table.data_vars:
        if table[name].dtype.kind in "fbi":
            kind = _kind(table, name)
            scales[kind] = max(
                scales.get(kind, 0.0), float(np.abs(table[name].values.astype(float)).max())
            )
    return scales


def _kind(table, name):
    """Component and unit of a signal; without a unit each signal is of its own kind."""
    unit = table[name].attrs.get("units", "")
    return (name.rpartition(".")[0], unit) if unit else (name, unit)
