"""The engine ecos, through ecospy; no other module imports it.

ecos gets the system as we read it, through its interface: models, one parameter set with every start value, and
connections. A connection that transforms, or that an event changes, gets a function of ours that ecos calls for each
value. Values are read through its interface after each step, since its CSV writer keeps six digits.
"""

from __future__ import annotations

import json
from collections import defaultdict
from contextlib import ExitStack
from ctypes import byref, c_bool, c_char_p, c_double, c_int, c_size_t, c_void_p, sizeof
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.cosim.engines.adapter import EngineError, Job, run_on, sums, unsupported
from shipcosim.cosim.engines.python_imports import imports_undone
from shipcosim.cosim.master.plan import End, label
from shipcosim.cosim.master.signals import Modifier
from shipcosim.errors import Problem, error_at, raise_errors
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.ssp import Connection, System

if TYPE_CHECKING:
    import xarray

TYPES = {
    "Real": ("real", c_double, float),
    "Integer": ("integer", c_int, int),
    "Boolean": ("bool", c_bool, bool),
}
"""Names and types of values in ecos."""
REMARK = "ecos does not say when an FMU fails, it goes on: compare the result with that of another engine."
START = "start"  # name of the parameter set; ecos applies none without a name


def run(system: System, scenario: Scenario, options: RunOptions) -> xarray.Dataset:
    """Run a checked system on ecos. See `shipcosim.cosim.simulate`."""
    check_installed()
    job = Job(system, scenario, options)
    added = sums(job.connections)
    raise_errors(
        unsupported(
            "ecos", job, lambda c: "it is added to others" if c in added else None, _problems(job)
        )
    )
    about = {"ecospy_version": version("ecospy"), "remarks": json.dumps([REMARK])}
    return run_on("ecos", EcosSession, job, about)


def check_installed() -> None:
    """Raise ShipcosimError with what to install."""
    try:
        import ecospy  # noqa: F401
    except (ImportError, OSError) as error:
        remedy = "Install it: pip install ecospy, and on Linux its library TBB (Debian: apt install libtbb12)."
        raise error_at("ecos", f"is not installed: {error}.", remedy) from error


def _problems(job):
    """Problems of ecos other than connections."""
    for name, multiple in job.plan.multiples.items():
        if multiple > 1:
            message = f"steps {multiple} base steps at a time; ecos only lets components step with the base step."
            yield Problem(name, message)
    for change in job.changes:
        if job.plan.variable(change.end).kind != "Real":
            message = f"is connected and not Real, so ecos knows no {change.action} of it."
            yield Problem(label(change.end), message)


@dataclass
class Transformation:
    """The change of each value that a connection passes on in ecos.

    Parameters
    ----------
    connection : Connection
        With its linear transformation.
    source, target : (scale, shift)
        Overrides and biases of its ends.
    """

    connection: Connection
    source: Modifier = (1, 0)
    target: Modifier = (1, 0)

    # The order is that of the model: modify the output, transform it, then modify the input.
    def __call__(self, value: float) -> float:
        value = _modified(value, self.source)
        # Skip the transformation where it is none, so that values stay exact.
        if self.connection.is_linear:
            value = self.connection.factor * value + self.connection.offset
        return _modified(value, self.target)


def _modified(value, modifier):
    return value if modifier == (1, 0) else modifier[0] * value + modifier[1]


class EcosSession:
    """A simulation of ecos.

    Parameters
    ----------
    job : Job
        Its task.
    """

    def __init__(self, job: Job):
        self._job = job
        self.n_done = 0
        self._transformations = defaultdict(list)
        self._changes = defaultdict(list)
        for change in job.changes:
            self._changes[change.step].append(change)
        self._records = [_Record(job, kind) for kind in TYPES]
        # If opening fails, the stack undoes what was opened so far.
        with ExitStack() as stack:
            stack.enter_context(imports_undone())
            self._open(stack)
            self._stack = stack.pop_all()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._stack.close()

    def set_input(self, end: End, value: float) -> None:
        """Set an input that no component feeds, from the next step on."""
        name, _, convert = TYPES[self._job.plan.variable(end).kind]
        getattr(self._simulation, f"set_{name}")(_identifier(end), convert(value))

    def advance(self, last: int) -> None:
        """Go on to the step of this number."""
        step = _function("step")
        simulation = c_void_p(self._simulation.sim)
        single_step = c_size_t(1)
        # Changes act before the step that starts at their time.
        for k in range(self.n_done, last):
            if k in self._changes:
                self._act(self._changes[k])
            step(simulation, single_step)
            self.n_done = k + 1
            # Each step is read at once, because ecos keeps no history in full precision.
            for record in self._records:
                record(simulation, k + 1)

    def outputs(self) -> dict[str, list[np.ndarray]]:
        """Values of all outputs at the start and after each step, by kind."""
        columns = {record.kind: record.columns(self.n_done + 1) for record in self._records}
        # ecos applies a bias or override on the way to the inputs only. The recorded output must
        # show it too, from the step after the change on.
        for row, end in enumerate(self._job.plan.layouts["Real"].outputs):
            unmodified = columns["Real"][row].copy()
            for change in (change for change in self._job.changes if change.end == end):
                after = slice(change.step + 1, None)
                columns["Real"][row][after] = _modified(unmodified[after], _modifier(change))
        return columns

    def _open(self, stack):
        from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

        EcosLib.set_log_level("off")
        try:
            self._structure = stack.enter_context(EcosSimulationStructure())
            self._fill(self._structure)
            step_size = self._job.scenario.step_size
            self._simulation = stack.enter_context(
                EcosSimulation(structure=self._structure, step_size=step_size)
            )
            self._simulation.init(parameter_set=START)
        except Exception as error:  # ecospy has no type of its own
            raise EngineError(str(error)) from error
        for record in self._records:
            record(c_void_p(self._simulation.sim), 0)

    def _fill(self, structure):
        # Start values go into a parameter set: ecos sets them during its initialisation.
        values = {}
        for name, component in self._job.system.components.items():
            structure.add_model(name, str(component.fmu.path.resolve()))
            for variable, value in self._job.starts(name).items():
                values[_identifier((name, variable))] = value
        structure.add_parameter_set(START, values)
        # A connection needs a Python function only if it transforms, or an event may change an end.
        # Others stay native and fast.
        modified = {change.end for change in self._job.changes}
        for connection in self._job.connections:
            kind = self._job.plan.variable(connection.source).kind
            ends = _identifier(connection.source), _identifier(connection.target)
            if connection.is_linear or modified & {connection.source, connection.target}:
                transformation = Transformation(connection)
                self._transformations[connection.source].append(transformation)
                self._transformations[connection.target].append(transformation)
                structure.make_real_connection(*ends, transformation)
            else:
                name = {"Integer": "int", "Boolean": "bool"}.get(kind, kind.lower())
                getattr(structure, f"make_{name}_connection")(*ends)

    def _act(self, changes):
        """Make the changes due before a step; inputs first, they use the values before it."""
        variable = self._job.plan.variable
        for change in sorted(
            changes, key=lambda change: variable(change.end).causality == "output"
        ):
            for transformation in self._transformations[change.end]:
                if transformation.connection.target == change.end:
                    # The input gets its new value at once, since the connection acts only after the
                    # step.
                    transformation.target = _modifier(change)
                    source = self._simulation.get_real(
                        _identifier(transformation.connection.source)
                    )
                    self._simulation.set_real(_identifier(change.end), transformation(source))
                else:
                    transformation.source = _modifier(change)


class _Record:
    """Values of all outputs of one kind, row by row, through calls of the library itself."""

    def __init__(self, job, kind):
        name, self._type, _ = TYPES[kind]
        ends = job.plan.layouts[kind].outputs
        self.kind = kind
        self._get = _function(f"get_{name}")
        # Names, places and buffer are prepared once: the calls run at every step.
        self._n = len(ends)
        self._values = (self._type * len(ends))()
        self._names = [c_char_p(_identifier(end).encode()) for end in ends]
        self._places = [byref(self._values, i * sizeof(self._type)) for i in range(len(ends))]
        self._row = np.frombuffer(self._values, dtype=self._type) if ends else np.empty(0)
        self._rows = np.empty((job.n_steps + 1, len(ends)), dtype=self._type)

    def __call__(self, simulation, row):
        """Keep the present values as a row."""
        if not all(map(self._get, [simulation] * self._n, self._names, self._places)):
            raise EngineError("It does not give all values.")
        self._rows[row] = self._row

    def columns(self, n_rows: int) -> list[np.ndarray]:
        """(n_rows,) arrays, one for each output."""
        return list(np.ascontiguousarray(self._rows[:n_rows].T))


def _identifier(end: End) -> str:
    return f"{end[0]}::{end[1]}"


def _modifier(change):
    """A change as (scale, shift): an override is (0, value), a bias (1, value)."""
    return {"override": (0, change.value), "bias": (1, change.value), "reset": (1, 0)}[
        change.action
    ]


def _function(name):
    """A function of ecos' library without ecospy's conversions, which cost more than the call."""
    from ecospy.lib import dll

    function = dll[f"ecos_simulation_{name}"]
    function.restype = c_double if name == "step" else c_bool
    return function
