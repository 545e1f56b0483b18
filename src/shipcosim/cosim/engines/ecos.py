"""The engine ecos, through ecospy. The only door to it.

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

from shipcosim.cosim.engines.adapter import EngineError, Job, complaints, is_linear, run_on, sums
from shipcosim.cosim.engines.traces import no_traces
from shipcosim.cosim.master.plan import End, label
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.ssp import Connection, System

if TYPE_CHECKING:
    import xarray

TYPES = {"Real": ("real", c_double, float), "Integer": ("integer", c_int, int), "Boolean": ("bool", c_bool, bool)}
"""Names and types that it has for values."""
REMARK = "ecos does not say when an FMU fails, it goes on: hold the result against that of another engine."
START = "start"  # name of the parameter set; ecos applies none without a name


def run(system: System, scenario: Scenario, options: RunOptions) -> xarray.Dataset:
    """Run a checked system on ecos. See `shipcosim.cosim.simulate`."""
    check_installed()
    job = Job(system, scenario, options)
    added = sums(job.connections)
    if problems := complaints("ecos", job, lambda c: "it is added to others" if c in added else None, _problems(job)):
        raise ShipcosimError(problems)
    about = {"ecospy_version": version("ecospy"), "remarks": json.dumps([REMARK])}
    return run_on("ecos", Session, job, about)


def check_installed() -> None:
    """Raise ShipcosimError with what to install."""
    try:
        import ecospy  # noqa: F401
    except (ImportError, OSError) as error:
        remedy = "Install it: pip install ecospy, and on Linux its library TBB (Debian: apt install libtbb12)."
        raise ShipcosimError(Problem("ecos", f"is not installed: {error}.", remedy)) from error


def _problems(job):
    """What ecos cannot do, beside connections."""
    for name, multiple in job.plan.multiples.items():
        if multiple > 1:
            found = f"steps {multiple} base steps at a time; ecos only lets components step with the base step."
            yield Problem(name, found)
    for _, change, end, _ in job.changes:
        if job.plan.variable(end).kind != "Real":
            yield Problem(label(end), f"is connected and not Real, so ecos knows no {change} of it.")


@dataclass
class Link:
    """What ecos does with each value on its way through a connection; (scale, shift) of changes to its ends."""

    connection: Connection
    source: tuple = (1, 0)
    target: tuple = (1, 0)

    def __call__(self, value):
        value = _changed(value, self.source)
        if is_linear(self.connection):
            value = self.connection.factor * value + self.connection.offset
        return _changed(value, self.target)


def _changed(value, change):
    return value if change == (1, 0) else change[0] * value + change[1]


class Session:
    """A simulation of ecos.

    Parameters
    ----------
    job : Job
        What it is to do.
    """

    def __init__(self, job: Job):
        self._job, self.n_done = job, 0
        self._links, self._changes = defaultdict(list), defaultdict(list)
        for change in job.changes:
            self._changes[change[0]].append(change[1:])
        self._records = [_Record(job, kind) for kind in TYPES]
        with ExitStack() as stack:
            stack.enter_context(no_traces())
            self._open(stack)
            self._stack = stack.pop_all()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._stack.close()

    def drive(self, end, value):
        """Set an input that nothing feeds, from the next step on."""
        name, _, convert = TYPES[self._job.plan.variable(end).kind]
        getattr(self._simulation, f"set_{name}")(_identifier(end), convert(value))

    def advance(self, last):
        """Go on to the step of this number."""
        step, simulation, one = _function("step"), c_void_p(self._simulation.sim), c_size_t(1)
        for k in range(self.n_done, last):
            if k in self._changes:
                self._act(self._changes[k])
            step(simulation, one)
            self.n_done = k + 1
            for record in self._records:
                record(simulation, k + 1)

    def outputs(self):
        """Values of all outputs at the start and after each step, by kind."""
        columns = {record.kind: record.columns(self.n_done + 1) for record in self._records}
        for row, end in enumerate(self._job.plan.layouts["Real"].outputs):
            plain = columns["Real"][row].copy()
            for k, change, changed, value in self._job.changes:
                if changed == end:
                    columns["Real"][row][k + 1 :] = _changed(plain[k + 1 :], _change(change, value))
        return columns

    def _open(self, stack):
        from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

        EcosLib.set_log_level("off")
        try:
            self._structure = stack.enter_context(EcosSimulationStructure())
            self._fill(self._structure)
            step_size = self._job.scenario.step_size
            self._simulation = stack.enter_context(EcosSimulation(structure=self._structure, step_size=step_size))
            self._simulation.init(parameter_set=START)
        except Exception as error:  # ecospy has no type of its own
            raise EngineError(str(error)) from error
        for record in self._records:
            record(c_void_p(self._simulation.sim), 0)

    def _fill(self, structure):
        values = {}
        for name, component in self._job.system.components.items():
            structure.add_model(name, str(component.fmu.path.resolve()))
            for variable, value in self._job.starts(name).items():
                values[_identifier((name, variable))] = value
        structure.add_parameter_set(START, values)
        changed = {end for _, _, end, _ in self._job.changes}
        for connection in self._job.connections:
            kind = self._job.plan.variable(connection.source).kind
            ends = _identifier(connection.source), _identifier(connection.target)
            if is_linear(connection) or changed & {connection.source, connection.target}:
                link = Link(connection)
                self._links[connection.source].append(link)
                self._links[connection.target].append(link)
                structure.make_real_connection(*ends, link)
            else:
                name = {"Integer": "int", "Boolean": "bool"}.get(kind, kind.lower())
                getattr(structure, f"make_{name}_connection")(*ends)

    def _act(self, changes):
        """Make changes that are due before a step: first those to inputs, which get the values from before it."""
        for change, end, value in sorted(changes, key=lambda c: self._job.plan.variable(c[1]).causality == "output"):
            for link in self._links[end]:
                if link.connection.target == end:
                    link.target = _change(change, value)
                    source = self._simulation.get_real(_identifier(link.connection.source))
                    self._simulation.set_real(_identifier(end), link(source))
                else:
                    link.source = _change(change, value)


class _Record:
    """Values of all outputs of one kind, row by row; what is not in ecospy is called as it calls it itself."""

    def __init__(self, job, kind):
        name, self._type, _ = TYPES[kind]
        ends = job.plan.layouts[kind].outputs
        self.kind, self._get, self._n = kind, _function(f"get_{name}"), len(ends)
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

    def columns(self, n_rows):
        """(n_rows,) arrays, one for each output."""
        return list(np.ascontiguousarray(self._rows[:n_rows].T))


def _identifier(end: End) -> str:
    return f"{end[0]}::{end[1]}"


def _change(change, value):
    """A change as (scale, shift)."""
    return {"override": (0, value), "bias": (1, value), "reset": (1, 0)}[change]


def _function(name):
    """A function of ecos' library, without ecospy's conversions, which would cost more than the call."""
    from ecospy.lib import dll

    function = dll[f"ecos_simulation_{name}"]
    function.restype = c_double if name == "step" else c_bool
    return function
