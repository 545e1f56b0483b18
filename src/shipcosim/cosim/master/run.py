"""Our own engine: plan a run, instantiate the FMUs, run the master, make one table."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import nullcontext
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.cosim.master.algorithm import Ended, Failure, Master
from shipcosim.cosim.master.compiled import ALL, LONG, CompiledMaster, why_in_python
from shipcosim.cosim.master.events import add_pace, event_actions, external_values
from shipcosim.cosim.master.groups import couple, exchanged_at_steps, groups_of, inner_connections
from shipcosim.cosim.master.inputs import digest, input_values
from shipcosim.cosim.master.instantiate import (
    Components,
    SlaveSource,
    make_components,
    make_exchanges,
    make_parameter_connections,
    make_string_connections,
)
from shipcosim.cosim.master.interrupt import delayed_interrupt
from shipcosim.cosim.master.order import ORDERS, stepping_order
from shipcosim.cosim.master.plan import make_plan
from shipcosim.cosim.master.ranges import range_remarks
from shipcosim.cosim.master.recorder import Recorder, Recorders
from shipcosim.cosim.master.rerun import can_rewind, changed_values, with_numbers
from shipcosim.cosim.master.restore import (
    check_fit,
    check_restored,
    check_storable,
    restore_snapshot,
    take_snapshot,
)
from shipcosim.cosim.master.result import Column, attributes_of, columns_of, recorded_rows
from shipcosim.cosim.master.time_grid import TimeGrid, time_grid_of
from shipcosim.cosim.processes.remote_slave import IsolatedInstances
from shipcosim.cosim.profile import MASTER, Profile
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.pythonfmu_code import module_clashes
from shipcosim.cosim.slaves.slave import ProcessEnded, SlaveError
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.options import CountProgress, RunOptions
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.snapshot import Snapshot, opened, writer
from shipcosim.ssp import System

if TYPE_CHECKING:
    import xarray


class RunError(ShipcosimError):
    """A run failed; `table` holds the rows before that, and is marked as incomplete."""

    def __init__(self, problems: Problem | Sequence[Problem], table: xarray.Dataset):
        super().__init__(problems)
        self.table = table

    @property
    def is_finding(self) -> bool:
        """Whether a component failed on its way, or its process ended; one that does not start is unusable input."""
        cause = getattr(self.__cause__, "__cause__", None)
        return self.table.sizes["time"] > 0 or isinstance(cause, ProcessEnded)


class Interrupted(KeyboardInterrupt):
    """A run was interrupted; `table` holds the rows before that, and is marked as incomplete."""

    def __init__(self, table: xarray.Dataset):
        super().__init__("the run was interrupted")
        self.table = table


def run(system: System, scenario: Scenario, options: RunOptions) -> xarray.Dataset:
    """Run a checked system with our own master. See `shipcosim.cosim.simulate`."""
    # Check everything that can fail before any FMU is loaded.
    resume = opened(options.resume)
    store = writer(options.store)
    if resume is not None:
        check_fit(resume, system, scenario)
    if store is not None or resume is not None:
        check_storable(system)
    # A continued run keeps the clock of the first one: steps count from its start.
    start_time, first = (resume.start_time, resume.step) if resume else (options.start_time, 0)
    simulation = Simulation(
        system, scenario, time_grid_of(scenario, start_time, first, options.until), options, resume
    )
    # Python has one module of a name in a process: FMUs that would take each other's get their own.
    is_apart = options.isolate or bool(simulation.clashes)
    instances = IsolatedInstances(system, options.timeout) if is_apart else Instances()
    # Ctrl-C is held back until the master can stop.
    with delayed_interrupt() as check_interrupt, instances:
        simulation.run(instances, check_interrupt, options.progress)
        if store is not None and simulation.is_ended:
            raise RunError(
                Problem("store", "an FMU has ended the run before its end, so there is no state."),
                simulation.table(complete=True),
            )
        if store is not None:
            store(simulation.snapshot())
        simulation.terminate()
    return simulation.table(complete=True)


class Simulation:
    """One run of a checked system, planned before anything is instantiated.

    Parameters
    ----------
    system : System
        With the scenario's start values.
    scenario : Scenario
        Checked against the system.
    grid : TimeGrid
        The steps that are done.
    options : RunOptions
        Order of the exchange, and the table that feeds inputs of the system.
    resume : Snapshot, optional
        Where the run continues from; checked.
    repeated : bool
        Whether it is to be run again with other start values.
    changeable : collection of str
        Inputs that are changed between two steps, whoever does it; each gets a row.

    Attributes
    ----------
    plan : Plan
    exchanges, recorders, components, strings
        Values and rows so far by kind; instances by name, and the texts that they exchange, once it has begun.
    is_ended : bool
        Whether an FMU has ended the run before the end of the grid.
    clashes : list of Problem
        Python modules of one name, for which the FMUs need a process each.

    Raises
    ------
    ShipcosimError
        If this cannot be run.
    """

    def __init__(
        self,
        system: System,
        scenario: Scenario,
        grid: TimeGrid,
        options: RunOptions,
        resume: Snapshot | None = None,
        repeated: bool = False,
        changeable: Collection[str] = (),
    ):
        order = options.order or scenario.order
        inputs = options.inputs
        self._realtime = options.realtime
        self._profile = Profile() if options.profile else None
        if order not in ORDERS:
            raise ShipcosimError(
                f"There is no order of exchange '{order}'. {suggestion(order, ORDERS)}"
            )
        self._scenario = scenario
        self._grid = grid
        self._order = order
        self._inputs = inputs
        self._resume = resume
        # Values of the table at all steps, computed once before the run.
        self._fed = fed = input_values(inputs, system, grid.run_times) if inputs is not None else {}
        self._active = resume.changes if resume else {}
        modified = [*self._active, *changeable]
        self.plan = make_plan(system, scenario, fed, modified, grid.start_time)
        self.exchanges = make_exchanges(self.plan)
        self._external = () if changeable else self._external_over_time()
        self._repeated = repeated
        self._fresh = None
        self.components: Components = {}
        self._together: list[set[str]] = []
        self.clashes = [] if options.isolate else module_clashes(system, late_alone=True)
        self._remarks = [f"{p.where}: {p.found} Each has its own process." for p in self.clashes]
        self._is_asked = options.engine == "native"
        self._engine = self._engine_of(options)
        self._master: Master | None = None
        self.is_ended = False
        # All rows are reserved before the run.
        self.recorders = Recorders(
            {
                kind: Recorder(exchange, len(grid.row_times), *recorded_rows(self.plan, kind))
                for kind, exchange in self.exchanges.items()
            }
        )

    def run(
        self,
        slaves: SlaveSource,
        check_interrupt: Callable[[], None],
        progress: CountProgress | None = None,
    ) -> None:
        """Go to the end of the time grid.

        Parameters
        ----------
        slaves : SlaveSource
            Where the FMUs' instances come from.
        check_interrupt : callable
            Raises KeyboardInterrupt where the user wants to stop.
        progress : callable, optional
            As in RunOptions.

        Raises
        ------
        RunError, Interrupted
            With the table so far.
        """
        grid = self._grid
        try:
            master = self.begin(slaves, check_interrupt)
            actions = event_actions(self._scenario, self.plan, self.exchanges, grid)
            if self._realtime is not None:
                add_pace(actions, grid, self._realtime, check_interrupt)
            master.run(grid, actions, self._external, self.recorders, progress)
        # An FMU may end the run: the rows until then are the result.
        except Ended as end:
            self._remarks.append(str(end))
            self.is_ended = True
        # Failures keep the rows so far: they show what led to it.
        except Failure as failure:
            raise RunError(failure.problem, self.table(complete=False)) from failure
        except KeyboardInterrupt:
            raise Interrupted(self.table(complete=False)) from None

    def begin(self, slaves: SlaveSource, check_interrupt: Callable[[], None]) -> Master:
        """The master, ready for the first step. Arguments as of `run`; raises Failure or KeyboardInterrupt."""
        grid = self._grid
        # A repeated run keeps its instances and connections.
        if self._master is None:
            with self._during("load"):
                self._instantiate(slaves, check_interrupt)
        master = self._master
        assert master is not None
        with self._during("start"):
            master.initialise(grid.start_time, grid.stop_time)
        if self._profile is not None and master.profile is None:
            master.count_in(self._profile)
            record = self.recorders.record
            self.recorders.record = self._profile.timed(MASTER, "record", record)
        # Continue from a snapshot: initialise as usual, then replace states and values.
        if self._resume is not None:
            restore_snapshot(self._resume, self.plan, self.exchanges, self.strings, self.components)
            master.resume(grid.first)
        return master

    def _engine_of(self, options):
        """The engine of this run; "auto" means the compiled one if compiling saves time."""
        if options.engine != "auto":
            return options.engine
        # By what is asked alone, not by what lies in the cache: the same run gives the same bits.
        steps = (self._grid.last - self._grid.first) * len(self.plan.system.components)
        if steps < LONG or options.isolate or self.clashes or options.realtime is not None:
            return "fmpy"
        is_sequential = self._order == "gauss-seidel"
        return (
            "fmpy"
            if why_in_python(is_sequential, self.plan.string_connections, self.exchanges)
            else "native"
        )

    def _during(self, phase):
        """Counts the time of a block, where it is asked for."""
        return nullcontext() if self._profile is None else self._profile.during(MASTER, phase)

    def _instantiate(self, slaves, check_interrupt):
        """Instantiate the FMUs and wire them."""
        plan = self.plan
        exchanges = self.exchanges
        step_size = self._scenario.step_size
        # A common solver needs all members in this process, stepped at the same time.
        apart = (
            ""
            if isinstance(slaves, Instances)
            else "isolated, each has a process and a solver of its own"
        )
        apart = (
            apart
            if self._order == "jacobi"
            else "one after the other, each steps with a solver of its own"
        )
        inner = [] if apart else inner_connections(plan)
        self._remarks += exchanged_at_steps(plan, inner, apart, step_size)
        # Instances first, since the group's solver takes them over.
        self.components = make_components(
            plan, exchanges, slaves, step_size, check_interrupt, inner
        )
        couple(plan, self.components, stepping_order(plan, self._order), inner)
        # For a repetition keep the state before the start; it is faster than a new instance.
        if self._repeated and can_rewind(plan, self.components):
            states = {
                name: component.slave.python_object._get_fmu_state()
                for name, component in self.components.items()
            }
            self._fresh = plan.system, states
        self._together = groups_of(inner)
        self.strings = make_string_connections(plan, self.components)
        self._master = self._new_master(self.strings, check_interrupt)

    def rewind(self, system: System, scenario: Scenario) -> bool:
        """Return to before the start for another run in the same arrays; true if possible.

        Parameters
        ----------
        system : System
            Made from the same system as before by `with_values`.
        scenario : Scenario
            Has to be that of before.
        """
        if self._fresh is None or scenario != self._scenario:
            return False
        before, states = self._fresh
        if (changed := changed_values(before, system)) is None:
            return False
        self.plan = with_numbers(self.plan, system)
        # Arrays keep their places, since prepared calls and compiled code point to them.
        for kind, exchange in self.exchanges.items():
            exchange.reset(
                np.array(
                    list(self.plan.layouts[kind].external.values()), dtype=exchange.sources.dtype
                )
            )
        self._external, self.recorders.n_rows = self._external_over_time(), 0
        try:
            for name, component in self.components.items():
                component.rewind(states[name], changed[name])
        except SlaveError:
            return False  # which says the run that begins anew
        return True

    def snapshot(self) -> Snapshot:
        """State of the system at the end of the grid, tried. Raises RunError if an FMU gives none, or a part."""
        # Compiled components have their state in arrays; copy it to the objects first.
        if self._master is not None:
            self._master.give_back()
        try:
            taken = take_snapshot(
                self.plan,
                self.exchanges,
                self.components,
                self._grid,
                self._scenario,
                self._active,
            )
            check_restored(taken, self.exchanges, self.components, self._grid)
            return taken
        except Failure as failure:
            raise RunError(failure.problem, self.table(complete=True)) from failure

    def terminate(self) -> None:
        """End the simulation in all FMUs."""
        for component in self.components.values():
            component.slave.terminate()

    @property
    def row_times(self) -> np.ndarray:
        """Times of the rows so far. [s]"""
        return self._grid.row_times[: self.recorders.n_rows]

    def columns(self, choose: Callable[[list[str]], Iterable[str]] = tuple) -> list[Column]:
        """Columns of the rows so far; `choose` selects names from all names."""
        columns = columns_of(self.plan, self.recorders.n_rows, self._recorded())
        # Copy the chosen columns: the arrays are used again by the next run.
        chosen = frozenset(choose([name for name, *_ in columns]))
        return [(c[0], np.array(c[1]), c[2], c[3]) for c in columns if c[0] in chosen]

    def _recorded(self):
        n = self.recorders.n_rows
        return {kind: recorder.columns(n) for kind, recorder in self.recorders.by_kind.items()}

    def attributes(self, complete: bool) -> dict[str, object]:
        """Facts about the run. `complete` is 1 or 0, since NetCDF has no truth values."""
        metadata = attributes_of(self.plan.system, self._scenario)
        # Where nothing could be compiled, Python has stepped all.
        in_python = self._in_python()
        engine = "fmpy" if ALL in in_python else self._engine
        metadata |= {"start_time": self._grid.start_time, "engine": engine, "order": self._order}
        if engine == "native" and in_python:
            metadata["stepped_by_python"] = ", ".join(in_python)
        if self._inputs is not None:
            metadata["inputs_sha256"] = digest(self._inputs)
        if self._grid.run_times[-1] < self._grid.times[-1]:
            metadata["until"] = float(self._grid.run_times[-1])
        if self._resume is not None:
            metadata["continued_from"] = self._resume.time
        if self._together:
            metadata["integrated_together"] = "; ".join(
                ", ".join(sorted(group)) for group in self._together
            )
        if self._profile is not None:
            metadata["profile"] = self._profile.as_json()
        return metadata | {"complete": int(complete), "remarks": json.dumps(self.remarks())}

    def _in_python(self) -> Mapping[str, str]:
        """Why Python steps components that were to be compiled, by name."""
        return self._master.reasons if isinstance(self._master, CompiledMaster) else {}

    def remarks(self) -> list[str]:
        """Remarks that do not stop the run, each once."""
        in_python = self._in_python()
        # Who leaves the engine to us need not know which component could not be compiled.
        if not self._is_asked and ALL not in in_python:
            in_python = {}
        remarks = [
            *self._remarks,
            *(f"stepped by Python, {name}: {reason}" for name, reason in in_python.items()),
        ]
        remarks += [
            text for component in self.components.values() for text in component.slave.remarks()
        ]
        remarks += range_remarks(self.plan, self.row_times, self._recorded())
        return list(dict.fromkeys(remarks))

    def table(self, complete: bool) -> xarray.Dataset:
        """Table of the rows so far."""
        return make_table(self.row_times, self.columns(), self.attributes(complete))

    def _external_over_time(self):
        """Changing external values of each exchange, with their values at each step."""
        changing = []
        for kind, exchange in self.exchanges.items():
            values = external_values(
                self._scenario, self.plan, kind, self._grid, self._fed, self._active
            )
            if values is not None:
                exchange.external[:] = values[0]
                changing.append((exchange.external, values))
        return changing

    def _new_master(self, strings, check_interrupt):
        return (CompiledMaster if self._engine == "native" else Master)(
            [self.components[name] for name in stepping_order(self.plan, self._order)],
            self.exchanges,
            strings,
            make_parameter_connections(self.plan, self.components),
            {kind: self.plan.layouts[kind].names for kind in self.exchanges},
            check_interrupt,
            sequential=self._order == "gauss-seidel",
        )
