"""The loop over the steps in compiled code, on the arrays of exchanges and components."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Container, Mapping, Sequence
from contextlib import nullcontext
from importlib.resources import files
from time import perf_counter
from types import MappingProxyType
from typing import Any

import numpy as np

from shipcosim.cosim.master.algorithm import (
    BETWEEN_REPORTS,
    Between,
    Master,
    failed_step,
    now_and_then,
)
from shipcosim.cosim.master.component import ComponentInstance
from shipcosim.cosim.master.recorder import Recorders
from shipcosim.cosim.master.signals import Exchange
from shipcosim.cosim.master.time_grid import TimeGrid
from shipcosim.cosim.profile import MASTER, Profile
from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.errors import ShipcosimError
from shipcosim.native import CompiledStep, Untraceable, compiled_steps, is_installed, libraries
from shipcosim.native.component import CALL
from shipcosim.options import CountProgress

DONE, FAILED, NOT_FINITE = range(3)
ALL = "all components"
LONG = 50_000
"""Steps of all components for which Python takes some five seconds; a DP system is compiled once in ten."""
HOST = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int, ctypes.c_int64)
INT = ctypes.c_int64
P = ctypes.c_void_p


def _fields(kind: Any, names: str) -> list[tuple[str, Any]]:
    """Fields of one type, named as in `native/loop.c`."""
    return [(name, kind) for name in names.split()]


class _Exchange(ctypes.Structure):
    _fields_ = [
        ("is_real", ctypes.c_int),
        *_fields(INT, "n_sources n_outputs n_inputs n_transferred"),
        *_fields(P, "sources modified transferred inputs"),
        ("n_connections", INT),
        *_fields(P, "source target period factor offset mapped mapping_first"),
        *_fields(P, "mapping_from mapping_to"),
        ("n_sums", INT),
        *_fields(P, "sum_row sum_first sum_end"),
        ("n_changes", INT),
        *_fields(P, "change_row change_exchange change_source"),
        *_fields(INT, "n_output_modifiers n_input_modifiers"),
        *_fields(P, "output_row input_row"),
        *_fields(P, "output_scale output_shift input_scale input_shift"),
        *_fields(P, "external rows"),
        *_fields(INT, "n_columns n_external_columns n_input_columns"),
        *_fields(P, "external_columns input_columns"),
        ("version", INT),
    ]


class _Component(ctypes.Structure):
    _fields_ = [
        *_fields(P, "step memory kept"),
        ("call", CALL),
        *_fields(INT, "n_memory multiple"),
        ("fixed_step", ctypes.c_double),
        *_fields(INT, "n_inputs n_outputs"),
        *_fields(P, "input_place input_exchange input_row"),
        *_fields(P, "output_place output_exchange output_row"),
    ]


class _System(ctypes.Structure):
    _fields_ = [
        *_fields(INT, "n_exchanges n_components"),
        *_fields(P, "exchanges components clock"),
        *_fields(INT, "first steps_per_row n_rows"),
        ("host", HOST),
        *_fields(INT, "real stop"),
        ("seconds", P),
    ]


def exchange_tables(
    exchange: Exchange,
    others: Sequence[Exchange],
    external: Sequence[int] | np.ndarray,
    inputs: Sequence[int] | np.ndarray,
) -> dict[str, Any]:
    """Constant parts of an exchange, by the names of the structure in `native/loop.c`.

    Parameters
    ----------
    exchange : Exchange
    others : sequence of Exchange
        All of the system, in the order of the loop.
    external, inputs : sequence of int
        Rows of the sources and of the inputs that are recorded beside all outputs.
    """
    # The loop takes connections in order of their period, as the Python exchange does.
    single, sums, _ = exchange.numbered
    due = sorted(single, key=lambda pair: pair[1].period)
    # Mappings lie in sequence in two arrays, keys and values; each connection knows its first
    # entry.
    mappings = [connection.mapping for _, connection in due if connection.mapping is not None]
    numbers = iter(range(len(mappings)))
    kinds = [id(other) for other in others]
    whole = {
        "source": [connection.source for _, connection in due],
        "target": [row for row, _ in due],
        "period": [connection.period for _, connection in due],
        "mapped": [-1 if connection.mapping is None else next(numbers) for _, connection in due],
        "mapping_first": np.cumsum([0, *(len(mapping) for mapping in mappings)]),
        "sum_row": [row for row, _ in sums],
        "sum_first": [terms.start for _, terms in sums],
        "sum_end": [terms.stop for _, terms in sums],
        "change_row": [row for row, _, _ in exchange.type_changes],
        "change_exchange": [kinds.index(id(other)) for _, other, _ in exchange.type_changes],
        "change_source": [source for _, _, source in exchange.type_changes],
        "external_columns": external,
        "input_columns": inputs,
    }
    real = {
        "factor": [connection.factor for _, connection in due],
        "offset": [connection.offset for _, connection in due],
        "mapping_from": [key for mapping in mappings for key in mapping],
        "mapping_to": [value for mapping in mappings for value in mapping.values()],
    }
    counts = {
        "n_sources": len(exchange.sources),
        "n_outputs": len(exchange.outputs),
        "n_inputs": len(exchange.inputs),
        "n_transferred": len(exchange.transferred),
        "n_connections": len(due),
        "n_sums": len(sums),
        "n_changes": len(exchange.type_changes),
        "n_columns": len(exchange.outputs) + len(external) + len(inputs),
        "n_external_columns": len(external),
        "n_input_columns": len(inputs),
    }
    tables = {name: np.array(values, dtype=np.int64) for name, values in whole.items()}
    return counts | tables | {name: np.array(values, float) for name, values in real.items()}


class CompiledMaster(Master):
    """The master with a compiled loop, for the components that can be compiled.

    The others are stepped by Python, and so are steps of a compiled component that its code gives up: errors are
    then reported as usual.

    Attributes
    ----------
    reasons : dict of str to str
        Components that Python steps, and why.
    """

    reasons: Mapping[str, str] = MappingProxyType({})
    _loop: _CompiledLoop | None = None

    def give_back(self) -> None:
        """See `Master.give_back`."""
        if self._loop is not None:
            self._loop.give_back()

    def take_back(self) -> None:
        """See `Master.take_back`."""
        if self._loop is not None:
            self._loop.take_back()

    def run(
        self,
        grid: TimeGrid,
        actions: Mapping[int, Sequence[Callable[[], None]]],
        external: Sequence[tuple[np.ndarray, np.ndarray]],
        recorders: Recorders,
        progress: CountProgress | None = None,
        between: Between | None = None,
    ) -> None:
        """See `Master.run`."""
        loop = self._loop_for(grid, external, recorders)
        if isinstance(loop, str):
            self.reasons = {ALL: loop}
            super().run(grid, actions, external, recorders, progress, between)
            return
        self._loop = loop
        k = first = grid.first
        last = grid.last
        steps = 16
        tell = now_and_then(progress)
        due = sorted(step for step in actions if step > first)
        meeting = last if between is None else first
        try:
            while k < last:
                if between is not None and k == meeting:
                    loop.give_versions()
                    k, meeting = between(k)
                    loop.take_modifiers()
                # Events act between calls, so a call never goes past the next event.
                if k in actions:
                    loop.give_versions()
                    self._act(actions[k])
                    loop.take_modifiers()
                try:
                    self._check_interrupt()
                    tell(k - first, last - first)
                except KeyboardInterrupt:
                    # The loop records a row only as it steps, so the row of this step is missing.
                    if k % grid.steps_per_row == 0:
                        recorders.record()
                    raise
                while due and due[0] <= k:
                    due.pop(0)
                # The call ends at the next event, at the end, or after a number of steps.
                end = min(k + steps, due[0] if due else last, meeting, last)
                began = perf_counter()
                k = loop.run(k, end)
                # Long calls are fast, short ones let Ctrl-C and progress through.
                is_quick = perf_counter() - began < 0.5 * BETWEEN_REPORTS
                steps = 2 * steps if is_quick else max(1, steps // 2)
        finally:
            self.reasons = loop.reasons
            loop.count_in(self.profile)
        if last % grid.steps_per_row == 0:
            recorders.record()
        tell(last - first, last - first)

    def _loop_for(self, grid, external, recorders) -> _CompiledLoop | str:
        """The loop of a run, or why Python steps all of it."""
        if why := why_in_python(self._sequential, self._string_connections, self._exchanges):
            return why
        # A repeated run uses the arrays of the run before, if only numbers differ.
        if self._loop is not None and self._loop.take_anew(external):
            return self._loop
        try:
            with nullcontext() if self.profile is None else self.profile.during(MASTER, "load"):
                return _CompiledLoop(self, grid, external, recorders)
        # The compiler fails, or the cache cannot be written.
        except ShipcosimError as error:
            return str(error)


def why_in_python(
    sequential: bool, string_connections: Sequence[object], kinds: Container[str]
) -> str:
    """Reason why no component of a run can be compiled; empty if some can."""
    if not is_installed():
        return "there is no compiler, install it: pip install 'shipcosim[native]'"
    if sequential:
        return "the components step one after the other, in the order gauss-seidel"
    if string_connections:
        return "texts are exchanged"
    return "whole numbers of 64 bits are exchanged" if "Long" in kinds else ""


class _CompiledLoop:
    """The arrays of a run as the compiled loop uses them."""

    def __init__(self, master: CompiledMaster, grid: TimeGrid, external, recorders: Recorders):
        self._master = master
        self._clock = np.ascontiguousarray(grid.times, dtype=float)
        self._recorders = recorders
        self._components = master._components
        self._exchanges = list(master._exchanges.items())
        self._kept: list[Any] = []  # arrays that the structures point to
        self._kept_for_now: dict[str, list[Any]] = {}
        self._library = libraries(
            [files("shipcosim.native").joinpath("loop.c").read_text(encoding="utf-8")]
        )[0]
        # The C structures point to the arrays of exchanges and components; nothing is copied per
        # step.
        self._steps = self._compiled(grid)
        self._error: BaseException | None = None
        self._seconds = np.zeros(len(self._components) + 2)
        self._c_exchanges = (_Exchange * len(self._exchanges))(
            *(self._exchange(kind, exchange) for kind, exchange in self._exchanges)
        )
        self._c_components = (_Component * len(self._components))(
            *map(self._component, self._components)
        )
        kinds = [kind for kind, _ in self._exchanges]
        self._host = HOST(self._stepped_by_python)
        self._system = _System(
            len(self._exchanges),
            len(self._components),
            ctypes.cast(self._c_exchanges, P),
            ctypes.cast(self._c_components, P),
            self._pointer(self._clock),
            grid.first,
            grid.steps_per_row,
            0,
            self._host,
            kinds.index("Real") if "Real" in kinds else -1,
            0,
            None if master.profile is None else self._pointer(self._seconds),
        )
        self._take_external(external)
        self.take_modifiers()

    def take_anew(self, external) -> bool:
        """Start again in the same arrays with other numbers; true if the code allows it."""
        time, step_size = self._first_step
        # A component that Python steps keeps its state outside the arrays; then the loop is built
        # anew.
        if self._reasons or not all(
            step.take_anew(time, step_size) for step in self._steps.values()
        ):
            return False
        self._error, self._system.stop = None, 0
        self._take_external(external)
        self.take_modifiers()
        return True

    def run(self, k: int, end: int) -> int:
        """Make the steps from k to end; return the next step. Raises Failure."""
        reached = INT(k)
        # The loop records rows itself, so the count goes in and comes back.
        self._system.n_rows = self._recorders.n_rows
        status = self._library.run(
            ctypes.byref(self._system), INT(k), INT(end), ctypes.byref(reached)
        )
        self._recorders.n_rows = self._system.n_rows
        # An error in a component was kept when it was raised: no exception passes through C.
        if status == FAILED:
            assert self._error is not None
            raise self._error
        # The master finds the signal and writes the message.
        if status == NOT_FINITE:
            self._master._check_finite(float(self._clock[reached.value]))
        return reached.value

    def count_in(self, profile: Profile | None) -> None:
        """Add what the loop has counted: steps of each component that it steps itself, exchange, recording."""
        if profile is None:
            return
        *steps, exchange, recording = self._seconds.tolist()
        for component, seconds in zip(self._components, steps, strict=True):
            profile.add(component.name, "step", seconds)
        profile.add(MASTER, "exchange", exchange)
        profile.add(MASTER, "record", recording)
        self._seconds[:] = 0.0

    def give_back(self) -> None:
        """Copy the numbers of compiled components to their Python objects."""
        for step in self._steps.values():
            step.give_back()

    def take_back(self) -> None:
        """Copy the numbers of the Python objects to the compiled components."""
        for component in self._components:
            if (compiled := self._steps.get(component.name)) is not None:
                self._take(component, compiled)

    def give_versions(self) -> None:
        """Tell Python how often the loop has changed discrete inputs, since it sets them only when the count changes."""
        for structure, (_, exchange) in zip(self._c_exchanges, self._exchanges, strict=True):
            exchange.version = structure.version

    def take_modifiers(self) -> None:
        """Copy the overrides and biases that act now."""
        # Only the active ones: the loop applies scale and shift on these rows.
        kept = self._kept_for_now["modifiers"] = []
        for structure, (_, exchange) in zip(self._c_exchanges, self._exchanges, strict=True):
            for name, modifiers in (
                ("output", exchange.output_modifiers),
                ("input", exchange.input_modifiers),
            ):
                active = modifiers.active
                setattr(structure, f"n_{name}_modifiers", len(active))
                setattr(
                    structure,
                    f"{name}_row",
                    self._pointer(np.array(list(active), dtype=np.int64), kept),
                )
                for column, part in enumerate(("scale", "shift")):
                    values = np.array(
                        [modifier[column] for modifier in active.values()], dtype=float
                    )
                    setattr(structure, f"{name}_{part}", self._pointer(values, kept))
            structure.version = exchange.version

    def _take_external(self, external) -> None:
        """Use the external values over time."""
        kept = self._kept_for_now["external"] = []
        over_time = {id(target): np.ascontiguousarray(values) for target, values in external}
        for structure, (_, exchange) in zip(self._c_exchanges, self._exchanges, strict=True):
            if (values := over_time.get(id(exchange.external))) is not None:
                structure.external = self._pointer(values, kept)

    @property
    def reasons(self) -> dict[str, str]:
        """Reasons why components are not compiled."""
        return {name: str(reason) for name, reason in self._reasons.items()}

    def _compiled(self, grid) -> dict[str, CompiledStep]:
        objects = {component.name: component.slave.python_object for component in self._components}
        # Only FMUs of our shell have Python code that can be recorded.
        own_fmus = {name: fmu for name, fmu in objects.items() if fmu is not None}
        # The first step serves as the example from which the code is recorded.
        time = float(grid.times[grid.first])
        self._first_step = time, float(grid.times[grid.first + 1]) - time
        steps = dict(
            zip(own_fmus, compiled_steps(list(own_fmus.values()), *self._first_step), strict=True)
        )
        self._reasons: dict[str, object] = {
            name: "its code is not ours" for name in objects if name not in own_fmus
        }
        self._reasons |= {
            name: step for name, step in steps.items() if isinstance(step, Untraceable)
        }
        return {name: step for name, step in steps.items() if isinstance(step, CompiledStep)}

    def _exchange(self, kind: str, exchange: Exchange) -> _Exchange:
        recorder = self._recorders.by_kind[kind]
        others = [other for _, other in self._exchanges]
        tables = exchange_tables(exchange, others, recorder.external, recorder.inputs)
        tables |= {
            "sources": exchange.sources,
            "modified": exchange.modified_sources,
            "transferred": exchange.transferred,
            "inputs": exchange.inputs,
            "rows": recorder.rows,
        }
        fields = {
            name: self._pointer(value) if isinstance(value, np.ndarray) else value
            for name, value in tables.items()
        }
        return _Exchange(is_real=int(kind == "Real"), version=exchange.version, **fields)

    def _component(self, component: ComponentInstance) -> _Component:
        # Without a compiled step the loop calls Python for this component.
        made = _Component(None, multiple=component.multiple, fixed_step=component.fixed_step or 0.0)
        step = self._steps.get(component.name)
        if step is None:
            return made
        kinds = {kind: number for number, (kind, _) in enumerate(self._exchanges)}
        made.step = step.function
        made.call = step.call
        made.n_memory = len(step.memory) - 2
        made.memory = self._pointer(step.memory)
        made.kept = self._pointer(step.kept)
        # Copies between memory and exchange: place in the memory, exchange, row.
        for name, rows in (("input", component.input_rows), ("output", component.output_rows)):
            table = [
                (step.places[variable.name], kinds[kind], first + number)
                for kind, (first, variables) in rows.items()
                for number, variable in enumerate(variables)
            ]
            setattr(made, f"n_{name}s", len(table))
            for column, part in enumerate(("place", "exchange", "row")):
                numbers = np.array([row[column] for row in table], dtype=np.int64)
                setattr(made, f"{name}_{part}", self._pointer(numbers))
        return made

    def _stepped_by_python(self, number: int, k: int) -> int:
        """Make a step in Python, or read outputs (number -1 - n); return 1 on failure."""
        reading = number < 0
        number = -1 - number if number < 0 else number
        component = self._components[number]
        try:
            self.give_versions()
            if reading:
                component.read()
            else:
                self._take_step(component, k)
            self._master._check_interrupt()
        # An interrupt ends the loop after this step, without an error.
        except KeyboardInterrupt:
            self._system.stop = 1
        # Keep the error: C returns to Python, which raises it.
        except SlaveError as error:
            began = k + 1 - component.multiple if reading else k
            self._error = failed_step(component, float(self._clock[began]), error)
            return 1
        except BaseException as error:
            self._error = error
            return 1
        return 0

    def _take_step(self, component, k):
        compiled = self._steps.get(component.name)
        # The object gets the state of the compiled memory, makes the step, and returns its state.
        if compiled is not None:
            compiled.give_back()
        component.write()
        time = float(self._clock[k])
        component.step(time, float(self._clock[k + component.multiple]) - time)
        if compiled is not None:
            self._take(component, compiled)

    def _take(self, component, compiled):
        # If the shape of the state has changed, Python steps this component from now on.
        try:
            compiled.take()
        except Untraceable as reason:
            self._reasons[component.name] = reason
            del self._steps[component.name]
            self._c_components[self._components.index(component)].step = None

    def _pointer(self, array, kept=None):
        (self._kept if kept is None else kept).append(array)
        return array.ctypes.data_as(P)
