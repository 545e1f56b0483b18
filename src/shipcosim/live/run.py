"""A run without end: it steps as far as its page asks, and takes changes between two steps."""

from __future__ import annotations

import json
import queue
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from math import isfinite
from time import perf_counter
from typing import Any, Protocol

import numpy as np

from shipcosim.cosim.interactive import changeable_inputs, kinds_of
from shipcosim.cosim.master.algorithm import Ended, Failure
from shipcosim.cosim.master.events import changes, modifiers_of
from shipcosim.cosim.master.interrupt import delayed_interrupt
from shipcosim.cosim.master.plan import label
from shipcosim.cosim.master.restore import check_storable
from shipcosim.cosim.master.run import Simulation
from shipcosim.cosim.master.signals import Exchange, Modifiers
from shipcosim.cosim.master.time_grid import TimeGrid, time_grid_of
from shipcosim.cosim.processes.remote_slave import IsolatedInstances
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.pythonfmu_code import module_clashes
from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.errors import ShipcosimError
from shipcosim.options import TIMEOUT, RunOptions
from shipcosim.scenario import Scenario, step_times
from shipcosim.ssp import System, with_values

LONGEST = 86400.0
"""A run ends after a day at the latest. [s]"""
MOST_STEPS, MOST_ROWS = 2_000_000, 400_000
"""It ends earlier where memory for its times and rows would not do: 1 GB for rows of 300 signals."""
SLICE = 0.03
"""Time between two looks at what the page asks. Assumed: nobody notices it. [s]"""
MOST_AT_ONCE = 4096
"""Steps between two such looks."""
EVERY, RECENT, MOST_STATES = 5.0, 60.0, 80
"""Time between two states to go back to, the age up to which all are kept, and their number. [s, s, 1]"""

NUMBERS = {"Real": int | float, "Integer": int, "Boolean": bool}
"""What a page sends for a signal of each kind."""

Change = tuple[int, str, str, Any]
"""Step before which it acts; override, bias or reset; signal; value."""


class Pages(Protocol):
    """The pages that show a run, and what they ask for: `LiveServer`."""

    inbox: queue.Queue[tuple[str, Any, str]]
    """What happened, the page that it came from, and its text: "joined", "left" or "asked"."""

    def send(self, *messages: str | bytes, to: Any = None) -> None:
        """Send messages to one page, which gets all others from then on; or to all pages that have joined."""
        ...

    def steers(self, page: Any) -> bool:
        """Whether this page steers; the others only read."""
        ...

    def refuse(self, page: Any) -> None:
        """Close the connection of a page that asks for what there is not."""
        ...


class _Again(Exception):
    """The run is to start again."""


@dataclass(frozen=True)
class _State:
    """A system between two steps: states of the FMUs by name, arrays and modifiers of each exchange."""

    fmus: dict[str, bytes]
    arrays: list[list[np.ndarray]]
    modifiers: list[list[dict]]


class LiveRun:
    """A run that its page steers.

    Parameters
    ----------
    system : System
        With the scenario's start values.
    scenario : Scenario
        Checked; its values in the units of the signals.
    pages : Pages
        The pages: which steers, and which get the rows.
    notify : callable
        Takes a sentence for the terminal.
    """

    def __init__(
        self, system: System, scenario: Scenario, pages: Pages, notify: Callable[[str], object]
    ):
        self._first_system = system
        self._scenario = scenario
        self._pages = pages
        self._notify = notify
        self._grid = endless_grid(scenario)
        self._spacing = max(round(EVERY / scenario.step_size), 1)
        self._starts: dict[str, float] = {}
        self._check_interrupt: Callable[[], None] = lambda: None
        # A state that an FMU does not give leaves no way back; the page says why.
        self._no_way_back = ""
        try:
            check_storable(system)
        except ShipcosimError as error:
            self._no_way_back = " ".join(str(problem) for problem in error.problems)

    def run(self) -> None:
        """Run until Ctrl-C: KeyboardInterrupt."""
        with delayed_interrupt() as self._check_interrupt:
            system = self._first_system
            apart = module_clashes(system, late_alone=True)
            with IsolatedInstances(system, TIMEOUT) if apart else Instances() as instances:
                while True:
                    with suppress(_Again):
                        self._run_once(instances)

    def _new_simulation(self) -> Simulation:
        system = with_values(self._first_system, self._starts, "the page")
        # The page changes any input, and all events act between two steps as what it changes does.
        named = [name for event in self._scenario.events for _, name, _ in event.changes]
        names = list(dict.fromkeys([*changeable_inputs(system), *named]))
        quiet = self._scenario.model_copy(update={"events": []})
        options = RunOptions(engine="native")
        return Simulation(system, quiet, self._grid, options, changeable=names)

    def _run_once(self, instances) -> None:
        """Start, and go on until the page starts again."""
        self._simulation = simulation = self._new_simulation()
        plan = simulation.plan
        events = changes(self._scenario, plan, self._grid)
        self._events: list[Change] = [
            (e.step, e.action, label(e.end), e.value or 0) for e in events
        ]
        self._done: list[Change] = []
        self._states: dict[int, _State] = {}
        self._waiting: list[tuple[Any, str]] = []
        self._failure = ""
        self._now, self._goal, self._sent, self._slice = 0, 1, 0, 1
        self._looked = perf_counter()
        self._greets = True
        try:
            self._master = simulation.begin(instances, self._check_interrupt)
        except Failure as failure:
            self._fail(str(failure))
            self._between(0)
        while True:
            try:
                self._master.run(self._grid, {}, (), simulation.recorders, None, self._between)
                self._fail(f"It has reached {self._grid.stop_time:g} s. Save it, and start again.")
            except (Failure, Ended) as failure:
                self._fail(str(failure))

    # ---- between two steps

    def _between(self, k: int) -> tuple[int, int]:
        """Wait until the page asks for more steps than k; change what is due. See `Between`."""
        if not self._failure:
            self._now = k
            late = perf_counter() - self._looked > SLICE
            self._slice = max(self._slice // 2, 1) if late else min(2 * self._slice, MOST_AT_ONCE)
            self._keep_state()
        # The first row belongs to the start: nobody can see a run without one.
        while self._now > 0 or self._failure:
            self._tell()
            self._take_messages()
            if self._goal > self._now and not self._failure:
                break
            if self._waiting:
                self._obey(*self._waiting.pop(0))
        # What is due now acts on the step that starts; then on to whatever comes first.
        k = self._now
        due = [change for change in (*self._events, *self._done) if change[0] == k]
        self._change(due)
        later = [change[0] for change in (*self._events, *self._done) if change[0] > k]
        next_state = (k // self._spacing + 1) * self._spacing
        self._looked = perf_counter()
        return k, min(self._goal, k + self._slice, next_state, *later)

    def _keep_state(self) -> None:
        """Keep the state to go back to where one is due: at the first step, and then in equal spaces."""
        is_due = self._now == 1 or (self._now % self._spacing == 0 and self._now > 0)
        if self._no_way_back or not is_due:
            return
        try:
            self._states[self._now] = self._state()
        except SlaveError as error:
            self._no_way_back = f"A component does not give its state: {error}"
            self._states.clear()
            self._greets = True
        # The older ones lie farther apart.
        if len(self._states) > MOST_STATES:
            recent = self._now - RECENT / EVERY * self._spacing
            kept = [step for n, step in enumerate(self._states) if step >= recent or n % 2 == 0]
            self._states = {step: self._states[step] for step in kept}

    def _take_messages(self) -> None:
        """Handle messages of the pages; wait for one while there is nothing to do."""
        while True:
            self._check_interrupt()
            idle = not self._waiting and (self._goal <= self._now or bool(self._failure))
            try:
                what, page, text = (
                    self._pages.inbox.get(timeout=0.2) if idle else self._pages.inbox.get_nowait()
                )
            except queue.Empty:
                if idle:
                    continue
                return
            if what == "joined":
                self._greet(page)
                continue
            # Steps that were asked for are given up where another start is wanted, or nobody steers any more.
            if what == "left" or '"advance"' not in text:
                self._goal = self._now
                self._waiting.clear()
            if what == "asked":
                self._waiting.append((page, text))
            else:
                time = self._grid.times[self._now]
                self._notify(
                    f"The page was closed at t = {time:.9g} s: the run pauses. Open it again to go on."
                )
                self._pages.send(json.dumps({"left": True}))

    def _obey(self, page: Any, text: str) -> None:
        """Do what a page asks for; refuse requests that our page never sends."""
        try:
            asked = json.loads(text)
            if asked["do"] == "advance":
                to = int(asked["to"])
                done = [self._checked(*change) for change in asked["changes"]]
                if not self._failure:
                    self._done += done
                    self._goal = min(to, self._grid.last)
                    if done:
                        self._pages.send(json.dumps({"acted": done}))
            elif asked["do"] == "back":
                self._go_back(int(asked["to"]))
            else:
                values = dict(asked["values"])
                if not all(isfinite(value) for value in values.values()):
                    raise ValueError(values)
                with_values(self._first_system, values, "the page")
                self._starts = values
                raise _Again
        except (LookupError, ValueError, TypeError, OverflowError, RecursionError, ShipcosimError):
            self._pages.refuse(page)

    def _checked(self, step: Any, action: Any, name: Any, value: Any) -> Change:
        """A change that a page asks for; ValueError if there is no such signal, action or value."""
        plan = self._simulation.plan
        end = plan.system.split(str(name))
        if end[0] is None:
            kinds = [kind for kind, layout in plan.layouts.items() if end in layout.external]
        else:
            kinds = [plan.kind_of(end)]
            modifiers_of(end, plan, self._simulation.exchanges)
        number = 0 if action == "reset" else value
        # The saved scenario takes an Integer and a Boolean as such only.
        fits = isfinite(number) and (kinds == ["Real"] or abs(number) < 2**31)
        is_of_kind = action == "reset" or isinstance(number, NUMBERS[kinds[0]])
        is_action = action in ("override", "bias", "reset")
        if not (is_action and fits and is_of_kind) or int(step) < self._now:
            raise ValueError(name)
        return int(step), action, str(name), number

    # ---- changes and states

    def _change(self, due: list[Change]) -> None:
        """Apply changes of one step."""
        plan = self._simulation.plan
        exchanges = self._simulation.exchanges
        # Inputs of the system are passed on with the values of this time, as `Master.run` does with external ones.
        for _, action, name, value in due:
            end = plan.system.split(name)
            for kind, exchange in exchanges.items() if end[0] is None else ():
                layout = plan.layouts[kind]
                if end in layout.external:
                    start: Any = layout.external[end] or 0
                    given = value if action == "override" else start + value
                    exchange.external[list(layout.external).index(end)] = given
        if due:
            for exchange in exchanges.values():
                exchange.transfer(self._now)
        # Overrides come after that: an output that is overridden now shows it from what this step puts out.
        for _, action, name, value in due:
            end = plan.system.split(name)
            if end[0] is not None:
                modifiers, row = modifiers_of(end, plan, exchanges)
                modifiers.put(row, 0 if action == "override" else 1, value)
        for exchange in exchanges.values() if due else ():
            exchange.refresh()

    def _state(self) -> _State:
        """The state between two steps. Raises SlaveError."""
        self._master.give_back()
        simulation = self._simulation
        fmus = {name: one.slave.state() for name, one in simulation.components.items()}
        exchanges = simulation.exchanges.values()
        arrays = [[values.copy() for values in arrays_of(exchange)] for exchange in exchanges]
        return _State(fmus, arrays, [[m.active for m in modifiers_in(e)] for e in exchanges])

    def _go_back(self, to: int) -> None:
        """Go back to a step, by a state at or before it; later changes are discarded."""
        if self._no_way_back or not self._states:
            raise ValueError("there is no state")
        # The latest state at or before the step: FMUs first, then the values that are exchanged.
        step = max((one for one in self._states if one <= to), default=min(self._states))
        state = self._states[step]
        simulation = self._simulation
        try:
            for name, component in simulation.components.items():
                component.restore(state.fmus[name])
        except SlaveError as error:
            self._fail(f"A component does not take its state back: {error}")
            return
        for exchange, arrays, active in zip(
            simulation.exchanges.values(), state.arrays, state.modifiers, strict=True
        ):
            for values, before in zip(arrays_of(exchange), arrays, strict=True):
                values[:] = before
            for modifiers, wanted in zip(modifiers_in(exchange), active, strict=True):
                for row in modifiers.active:
                    modifiers.reset(row)
                for row, modifier in wanted.items():
                    modifiers.put(row, *modifier)
        # Texts are passed on again, since the FMUs may have others; compiled components take the numbers of their FMUs.
        for connection in simulation.strings:
            connection.last = None
        self._master.take_back()
        # From here on the run knows nothing of what came later.
        self._done = [change for change in self._done if change[0] < to]
        self._states = {one: kept for one, kept in self._states.items() if one <= step}
        self._now, self._goal, self._failure = step, max(to, step), ""
        simulation.recorders.n_rows = -(-step // self._grid.steps_per_row)
        self._greets = True

    # ---- messages to the pages

    def _fail(self, why: str) -> None:
        """The run cannot go on: tell the pages after the rows so far, and keep to what was done."""
        self._failure = why
        recorders = self._simulation.recorders
        self._now = max(self._now, (recorders.n_rows - 1) * self._grid.steps_per_row + 1)
        self._done = [change for change in self._done if change[0] <= self._now]
        self._tell()
        self._pages.send(json.dumps({"failed": why, "step": self._now}))

    def _tell(self) -> None:
        """Send the rows that are new to all pages; everything where the run is another than before."""
        if self._greets and self._simulation.recorders.n_rows:
            self._greets = False
            self._pages.send(*self._greeting())
        elif self._simulation.recorders.n_rows > self._sent:
            self._pages.send(self._rows(self._sent))
        self._sent = self._simulation.recorders.n_rows

    def _greet(self, page: Any) -> None:
        steers = json.dumps({"steers": self._pages.steers(page)})
        self._pages.send(steers, *self._greeting(), to=page)
        if self._pages.steers(page):
            self._pages.send(json.dumps({"taken": True}))

    def _greeting(self) -> tuple[str, bytes]:
        run = {
            "step": self._now if self._failure else self._goal,
            "done": self._done,
            "starts": self._starts,
            "noWayBack": self._no_way_back,
            "failure": self._failure,
        }
        return json.dumps({"run": run}), self._rows(0)

    def _rows(self, first: int) -> bytes:
        """Steps done and number of rows, then the rows of each kind, all as float64."""
        recorders = self._simulation.recorders
        rows = [
            recorders.by_kind[kind].rows[first : recorders.n_rows].astype(float).tobytes()
            for kind in kinds_of(self._simulation.plan)
        ]
        head = np.array([self._now, recorders.n_rows - first], float)
        return b"".join([head.tobytes(), *rows])


def endless_grid(scenario: Scenario) -> TimeGrid:
    """Time grid of a run that ends when nobody can want it any more."""
    grid = time_grid_of(scenario)
    step = scenario.step_size
    last = min(int(LONGEST / step), MOST_STEPS, MOST_ROWS * grid.steps_per_row)
    # The step of a slow component may go beyond the end.
    times = step_times(step, 0, last + int(LONGEST / 24 / step))
    return TimeGrid(0.0, float(times[-1]), 0, last, times, grid.steps_per_row)


def arrays_of(exchange: Exchange) -> list[np.ndarray]:
    """Arrays of an exchange that change from step to step."""
    return [exchange.sources, exchange.modified_sources, exchange.transferred, exchange.inputs]


def modifiers_in(exchange: Exchange) -> tuple[Modifiers, Modifiers]:
    """Overrides and biases of an exchange's outputs and inputs."""
    return exchange.output_modifiers, exchange.input_modifiers
