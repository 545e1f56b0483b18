"""Compare one run on several engines and with half the step: differences of signals and causes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from time import perf_counter

import numpy as np

from shipcosim.cosim.differences import (
    TOLERANCE,
    Difference,
    difference,
    differs,
    explained,
)
from shipcosim.cosim.engines.registry import ENGINES, OWN, engines_missing
from shipcosim.cosim.master.run import RunError
from shipcosim.cosim.simulate import simulate
from shipcosim.errors import ShipcosimError, shortened
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.ssp import System

OURS = "fmpy"


@dataclass(frozen=True)
class Signal:
    """A signal in all runs.

    Parameters
    ----------
    name, unit : str
        As in the table.
    range : float
        Largest minus smallest value in our run.
    engines : dict of str to Difference
        Of each other engine that has the signal, from ours.
    step : Difference or None
        Of our run with half of all steps from that with the whole ones; None where the system does not run with half.
    agreeing : list of list of str
        Engines that agree with each other; ours is in the first of these groups.
    causes : dict of str to list of str
        By engine: what makes its signal another one, where that is known.
    """

    name: str
    unit: str
    range: float
    engines: Mapping[str, Difference]
    step: Difference | None
    agreeing: list[list[str]] = field(default_factory=list)
    causes: Mapping[str, list[str]] = field(default_factory=dict)

    @property
    def worst(self) -> float:
        """Largest relative difference between engines; infinite where a value is NaN."""
        largest = [difference.relative for difference in self.engines.values()]
        return max((np.inf if np.isnan(value) else value for value in largest), default=0.0)


@dataclass(frozen=True)
class Comparison:
    """The result of a comparison.

    Parameters
    ----------
    signals : list of Signal
        The largest difference between engines first, then the largest step-size error.
    seconds : dict of str to float
        How long each engine that ran took, ours first. [s]
    left_out : dict of str to str
        Why an engine did not run.
    remarks : dict of str to list of str
        What explains the differences of an engine, in words; empty where there are none to explain.
    tolerance : float
        Relative difference above which a signal differs.
    failed : tuple of str
        Engines that started and did not get to the end.
    """

    signals: list[Signal]
    seconds: Mapping[str, float]
    left_out: Mapping[str, str]
    remarks: Mapping[str, list[str]]
    tolerance: float
    failed: tuple[str, ...] = ()

    @property
    def agree(self) -> bool:
        """True if all engines that started agree on every signal."""
        return not self.failed and all(signal.worst <= self.tolerance for signal in self.signals)


def compare(
    system: System,
    scenario: Scenario,
    options: RunOptions | None = None,
    *,
    tolerance: float = TOLERANCE,
    readers: Mapping[str, Callable] | None = None,
    taken: Callable[[str], tuple] | None = None,
) -> Comparison:
    """Run on every engine that is installed, and on ours with half the step.

    Parameters
    ----------
    system, scenario
        As for `shipcosim.cosim.simulate`.
    options : RunOptions, optional
        As for `shipcosim.cosim.simulate`, without the engine; progress covers all runs.
    tolerance : float
        Difference above which a signal differs, relative to its range.
    readers : mapping of str to callable, optional
        Tools that read the file themselves, in place of the engines; see
        `shipcosim.cosim.engines.foreign_process.readers`.
    taken : callable, optional
        Says in which respects a tool takes the system otherwise, as `ssp.portability.as_interpreted.taken_by` does.

    Raises
    ------
    ShipcosimError
        If our own engine cannot run it.
    """
    # Engines that are not installed are no error: the comparison reports why they are missing.
    left_out = {name: str(problem) for name, problem in engines_missing().items()}
    names = [name for name in readers or ENGINES if name not in left_out and name not in OWN]
    # Three parts beside the engines: our run, and the one with half the step (twice as long).
    runs = _Runs(system, options or RunOptions(), len(names) + 3)
    # Engines are compared at every step: a coarse table would hide where a difference begins.
    scenario = scenario.model_copy(update={"output_interval": None})
    ours = runs.run(OURS, scenario)
    tables = {}
    # The change with half the step estimates the error that the step size causes. A difference
    # between engines below it is no fault of an engine.
    half = runs.run_halved(scenario)
    seconds = {OURS: runs.seconds[0]}
    failed = []
    for name in names:
        try:
            tables[name] = runs.run(name, scenario, reader=(readers or {}).get(name))
            seconds[name] = runs.seconds[-1]
        except ShipcosimError as error:
            left_out[name] = str(error)
            # Only a run that started counts as failed; an engine that refuses the system does not.
            failed += [name] if isinstance(error, RunError) else []
    # Without another engine report all signals, else those that some engine returns.
    compared = [
        name
        for name in ours.data_vars
        if not tables or any(name in table for table in tables.values())
    ]
    signals = [_signal(name, ours, tables, half, tolerance) for name in compared]
    # First from the tables alone: the simplest relation between ours and theirs.
    remarks = {
        name: explained(ours, table, scenario.step_size, tolerance)
        for name, table in tables.items()
    }
    # Then, where it is known how a tool interprets the file, repeat its deviations here. They
    # replace the guesses only if they explain something.
    for name in [name for name in tables if remarks[name]]:
        if taken is None:
            break
        reading_remarks, causes = _explained_by_reading(
            name, taken(name), ours, tables[name], scenario, tolerance
        )
        remarks[name] = [remarks[name][0], *reading_remarks] if reading_remarks else remarks[name]
        signals = [_with_cause(signal, name, causes) for signal in signals]
    # The worst signal first, then the one with the largest step-size error.
    signals.sort(
        key=lambda signal: (signal.worst, signal.step.relative if signal.step else 0.0),
        reverse=True,
    )
    return Comparison(signals, seconds, left_out, remarks, tolerance, tuple(failed))


def _with_cause(signal, engine, causes):
    cause = causes.get(signal.name)
    return signal if cause is None else replace(signal, causes={**signal.causes, engine: cause})


def _explained_by_reading(host, taken, ours, theirs, scenario, tolerance):
    """Run a tool's known deviations here; return remarks, and causes by signal."""
    respects, whole = taken
    remarks = []
    causes = {}
    names = [name for name in ours.data_vars if name in theirs]
    differing = [name for name in names if differs(name, ours, theirs, tolerance)]
    try:
        # Each deviation alone: the differing signals that it changes are its effect.
        for respect in respects:
            alone = simulate(respect.system, scenario)
            changed = [name for name in differing if differs(name, ours, alone, tolerance)]
            remarks.append(
                f"{respect.what}. This changes {shortened(changed) or 'nothing that differs'}."
            )
            for name in changed:
                causes.setdefault(str(name), []).append(respect.what)
        # All together: if the result equals the tool's, nothing remains to be explained.
        together = simulate(whole, scenario) if respects else ours
    # A deviation can make the system impossible to run here; then nothing is explained.
    except ShipcosimError:
        return [], {}
    left = [name for name in names if differs(name, together, theirs, tolerance)]
    if respects and not left:
        remarks.append(f"Run here with that, every signal is that of {host}.")
    elif respects:
        remarks.append(f"That does not explain all of {shortened(left)}.")
    return remarks, causes


def halved(system: System, scenario: Scenario) -> tuple[System, Scenario]:
    """System and scenario with half of all steps, those of components' own too, and a row at every whole step."""
    step = scenario.step_size
    components = {
        name: replace(component, step_size=component.step_size / 2.0)
        if component.step_size
        else component
        for name, component in system.components.items()
    }
    return replace(system, components=components), scenario.model_copy(
        update={"step_size": step / 2.0, "output_interval": step}
    )


class _Runs:
    """Runs in sequence, timed, with one progress over all of them."""

    def __init__(self, system, options, n_parts):
        self.system = system
        self.options = options
        self.n_parts = n_parts
        self.seconds = []
        self._done = 0

    def run_halved(self, scenario):
        """Our run with half of all steps; None where the system does not run so."""
        whole = self.system
        self.system, scenario = halved(whole, scenario)
        try:
            return self.run(OURS, scenario, weight=2)
        except ShipcosimError:
            return None
        finally:
            self.system = whole

    def run(self, engine, scenario, weight=1, reader=None):
        def report(done, total):
            if self.options.progress is not None:
                self.options.progress(self._done + weight * done / total, self.n_parts)

        begin = perf_counter()
        try:
            if reader is not None:
                return reader(self.system)
            return simulate(
                self.system, scenario, replace(self.options, engine=engine, progress=report)
            )
        # Count the part even after an error, so that the progress reaches its end.
        finally:
            self._done += weight
            self.seconds.append(perf_counter() - begin)


def _signal(name, ours, tables, half, tolerance):
    spread = float(np.ptp(ours[name].values.astype(float)))
    having = {engine: table for engine, table in tables.items() if name in table}
    engines = {engine: difference(name, ours, table) for engine, table in having.items()}
    step = None if half is None else difference(name, ours, half)
    groups = _groups(name, {OURS: ours} | having, tolerance)
    return Signal(str(name), ours[name].attrs.get("units", ""), spread, engines, step, groups)


def _groups(name, tables, tolerance):
    """Groups of engines that agree with the first of their group."""
    # Agreement is tested against the first engine only; ours is the first of the first group.
    groups = []
    for engine, table in tables.items():
        for group in groups:
            if not differs(name, tables[group[0]], table, tolerance):
                group.append(engine)
                break
        else:
            groups.append([engine])
    return groups
