"""A run without end: it steps as far as its page asks, and takes changes between two steps."""

from __future__ import annotations

import json
import queue
from collections.abc import Callable
from contextlib import suppress
from math import isfinite
from time import perf_counter
from typing import Any, Protocol

import numpy as np

from shipcosim.cosim.interactive import kinds_of, row_signals
from shipcosim.cosim.master.algorithm import Ended, Failure
from shipcosim.cosim.master.events import changes, modifiers_of
from shipcosim.cosim.master.interrupt import delayed_interrupt
from shipcosim.cosim.master.plan import label
from shipcosim.cosim.master.restore import check_storable
from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.errors import ShipcosimError
from shipcosim.live.forecast import Forecaster, Question
from shipcosim.live.simulation import (
    Change,
    SystemState,
    apply_changes,
    endless_grid,
    endless_simulation,
    instances_of,
    restore,
    state_of,
)
from shipcosim.scenario import Scenario
from shipcosim.ssp import System, with_values

SLICE = 0.03
"""Time between two looks at what the page asks. Assumed: nobody notices it. [s]"""
MOST_AT_ONCE = 4096
"""Steps between two such looks."""
EVERY, RECENT, MOST_STATES = 5.0, 60.0, 80
"""Time between two states to go back to, the age up to which all are kept, and their number. [s, s, 1]"""
MOST_LOSSES, FARTHEST = 50, 36_000
"""Losses of a forecast, and its steps."""

NUMBERS = {"Real": int | float, "Integer": int, "Boolean": bool}
"""What a page sends for a signal of each kind."""


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
            with instances_of(system) as instances:
                while True:
                    started = with_values(system, self._starts, "the page")
                    with suppress(_Again), Forecaster(started, self._scenario) as self._forecaster:
                        self._run_once(started, instances)

    def _run_once(self, system: System, instances) -> None:
        """Start, and go on until the page starts again."""
        self._simulation = simulation = endless_simulation(system, self._scenario, self._grid)
        plan = simulation.plan
        events = changes(self._scenario, plan, self._grid)
        self._events: list[Change] = [
            (e.step, e.action, label(e.end), e.value or 0) for e in events
        ]
        self._done: list[Change] = []
        self._states: dict[int, SystemState] = {}
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
                end = self._grid.times[self._grid.last]
                self._fail(f"it has reached {end:g} s, the longest run of a page")
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
        apply_changes(self._simulation, k, due)
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
            self._states[self._now] = state_of(self._simulation, self._master)
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
            if what == "left" or not ('"advance"' in text or '"forecast"' in text):
                self._goal = self._now
                self._waiting = [message for message in self._waiting if '"forecast"' in message[1]]
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
            request = json.loads(text)
            if request["do"] == "advance":
                to = int(request["to"])
                done = [self._checked(*change) for change in request["changes"]]
                if not self._failure:
                    self._done += done
                    self._goal = min(to, self._grid.last)
                    if done:
                        self._pages.send(json.dumps({"acted": done}))
            elif request["do"] == "back":
                self._go_back(int(request["to"]))
            elif request["do"] == "forecast":
                self._forecast(request["losses"], int(request["steps"]), request["watched"])
            else:
                values = dict(request["values"])
                if not all(isfinite(value) for value in values.values()):
                    raise ValueError(values)
                with_values(self._first_system, values, "the page")
                self._starts = values
                # A forecast of the old run gets no answer any more.
                self._pages.send(json.dumps({"forecast": {"error": ""}}))
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

    # ---- states

    def _forecast(self, losses: list, steps: int, watched: list) -> None:
        """Have the time after each loss, a list of changes, computed from the present state; all pages get the answer."""

        def answer(forecast: dict[str, Any]) -> None:
            self._pages.send(json.dumps({"forecast": forecast}))

        present = self._now
        signals = row_signals(self._simulation.plan, "Real")
        if len(losses) > MOST_LOSSES or steps > FARTHEST or not set(watched) <= set(signals):
            raise ValueError(watched)
        # What the scenario and the page change in that time happens in each future.
        changes = (*self._events, *self._done)
        coming = [change for change in changes if present <= change[0] < present + steps]
        futures = [
            [*coming, *(self._checked(present, *change) for change in loss)] for loss in losses
        ]
        if reason := self._failure or self._no_way_back:
            answer({"error": reason})
            return
        try:
            state = state_of(self._simulation, self._master)
        except SlaveError as error:
            answer({"error": str(error)})
            return
        self._forecaster.ask(Question(present, state, steps, futures, watched), answer)

    def _go_back(self, to: int) -> None:
        """Go back to a step, by a state at or before it; later changes are discarded."""
        if self._no_way_back or not self._states:
            raise ValueError("there is no state")
        step = max((number for number in self._states if number <= to), default=min(self._states))
        try:
            restore(self._simulation, self._master, self._states[step])
        except SlaveError as error:
            self._fail(f"A component does not take its state back: {error}")
            return
        # From here on the run knows nothing of what came later.
        self._done = [change for change in self._done if change[0] < to]
        self._states = {number: kept for number, kept in self._states.items() if number <= step}
        self._now, self._goal, self._failure = step, max(to, step), ""
        self._simulation.recorders.n_rows = -(-step // self._grid.steps_per_row)
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
