"""The engine libcosim of the Open Simulation Platform; only this module imports libcosimpy.

libcosim takes little of an SSP: parameters bound to components and plain connections. Therefore it gets the system as
we read it, in the form of its own that has most: simulators with their steps, connections, and a function for each
linear transformation, in an OspSystemStructure.xml; start values through its interface, where numbers stay exact and
texts may be long. Events become a scenario of its own.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import ExitStack
from ctypes import POINTER, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint32
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from shipcosim.cosim.engines.adapter import EngineError, Job, held, indices, run_on
from shipcosim.cosim.engines.osp_job import (
    events_json,
    nanoseconds,
    structure_of,
    unsupported_by_libcosim,
)
from shipcosim.cosim.engines.python_imports import imports_undone
from shipcosim.cosim.master.plan import End
from shipcosim.errors import error_at, raise_errors
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.ssp import System
from shipcosim.temporary import temporary_folder

if TYPE_CHECKING:
    import xarray

SERIES = {
    "Real": ("REAL", "real", c_double, np.float64),
    "Integer": ("INTEGER", "integer", c_int, np.int32),
}
"""Variable types that its observer of time series can record."""


def run(system: System, scenario: Scenario, options: RunOptions) -> xarray.Dataset:
    """Run a checked system on libcosim. See `shipcosim.cosim.simulate`."""
    check_installed()
    job = Job(system, scenario, options)
    raise_errors(unsupported_by_libcosim(job))
    return run_on("libcosim", LibcosimSession, job, {"libcosimpy_version": version("libcosimpy")})


def check_installed() -> None:
    """Raise ShipcosimError with what to install."""
    try:
        from libcosimpy._internal import libcosimc

        libcosimc()
    except (ImportError, OSError) as error:
        raise error_at(
            "libcosim",
            f"is not installed: {error}.",
            "Install it: pip install libcosimpy (Linux and Windows on x86-64).",
        ) from error


class LibcosimSession:
    """An execution of libcosim.

    Parameters
    ----------
    job : Job
        Its task.
    """

    def __init__(self, job: Job):
        self._job = job
        self._stack = ExitStack()
        self._execution: Any = None
        self._series: Any = None
        self._override: Any = None
        self._step = nanoseconds(job.scenario.step_size)
        self._stack.enter_context(imports_undone())
        self._folder = Path(self._stack.enter_context(temporary_folder()))
        # The constructor cannot use a `with` block: free everything by hand if opening fails.
        try:
            self._open()
        except BaseException:
            self.__exit__()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._execution = self._series = self._flags = self._override = self._events = None
        self._stack.close()

    def set_input(self, end: End, value: float) -> None:
        """Set an input that no component feeds, from the next step on."""
        name = end[0]
        variable = self._job.plan.variable(end)
        set_values = getattr(self._override, f"slave_{variable.kind.lower()}_values")
        self._check(set_values(self._indices[str(name)], [variable.value_reference], [value]))

    def advance(self, last: int) -> None:
        """Go on to the step of this number."""
        self._check(self._execution.step(last - self.n_done))

    @property
    def n_done(self) -> int:
        """Steps done."""
        return round(self._execution.status().current_time / self._step)

    def outputs(self) -> dict[str, list[np.ndarray]]:
        """Values of all outputs at the start and after each step, by kind. Ends the execution."""
        # libcosim records each variable only at the steps of its component; `held` fills the steps
        # between.
        n_rows = self.n_done + 1
        columns = {}
        for kind in SERIES:
            columns[kind] = [None] * len(self._job.plan.layouts[kind].outputs)
            for name, slave in self._indices.items():
                for row, variable in zip(*indices(self._job, name, kind), strict=True):
                    columns[kind][row] = held(*self._samples(kind, slave, variable, n_rows), n_rows)
        columns["Boolean"] = self._flag_columns(n_rows)
        return columns

    def _open(self):
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimManipulator import CosimManipulator

        log_output_level(CosimLogLevel.FATAL)
        # libcosim takes the structure from a file, with our connections and transformations in it.
        structure = self._folder / "OspSystemStructure.xml"
        structure.write_text(structure_of(self._job), encoding="utf-8")
        try:
            self._execution = CosimExecution.from_osp_config_file(str(structure))
        except AssertionError as error:
            raise EngineError(str(error)) from error
        # Start values go through the interface, where numbers stay exact. They must be set before
        # the first step.
        self._indices: dict[str, int] = {
            name: self._execution.slave_index_from_instance_name(name)
            for name in self._job.system.components
        }
        for name in self._job.system.components:
            self._start(name)
        # One manipulator sets inputs from outside, another one makes the events.
        self._override = CosimManipulator.create_override()
        self._check(self._execution.add_manipulator(self._override))
        self._load_events()
        self._observe()

    def _start(self, name):
        variables = self._job.system.components[name].variables
        slave = self._indices[name]
        for variable, value in self._job.starts(name).items():
            kind = variables[variable].kind
            reference = variables[variable].value_reference
            self._check(
                getattr(self._execution, f"{kind.lower()}_initial_value")(slave, reference, value)
            )

    def _load_events(self):
        from libcosimpy.CosimManipulator import CosimManipulator

        self._events = CosimManipulator.create_scenario_manager()
        self._check(self._execution.add_manipulator(self._events))
        if self._job.changes:
            file = self._folder / "events.json"
            file.write_text(events_json(self._job), encoding="utf-8")
            self._check(self._execution.load_scenario(self._events, str(file)))

    def _observe(self):
        from libcosimpy.CosimEnums import CosimVariableType
        from libcosimpy.CosimObserver import CosimObserver

        # Two rows more than steps: the start, and one in reserve.
        self._series = CosimObserver.create_time_series(self._job.n_steps + 2)
        self._check(self._execution.add_observer(self._series))
        for kind, (type_name, *_) in SERIES.items():
            for name, slave in self._indices.items():
                for variable in indices(self._job, name, kind)[1]:
                    start = self._series.start_time_series
                    self._check(
                        start(slave, variable.value_reference, CosimVariableType[type_name])
                    )
        # Booleans need an observer of their own, see FlagObserver.
        self._flags = None
        if self._job.plan.layouts["Boolean"].outputs:
            self._flags = FlagObserver(self._folder, self._flag_names())
            self._check(self._execution.add_observer(self._flags))

    def _flag_names(self):
        named = {
            name: [v.name for v in indices(self._job, name, "Boolean")[1]] for name in self._indices
        }
        return {name: flags for name, flags in named.items() if flags}

    def _samples(self, kind, slave, variable, n_rows):
        """Observed values and their step numbers; libcosimpy's own call loses the last."""
        _, name, c_type, dtype = SERIES[kind]
        values = np.zeros(n_rows, dtype)
        steps = np.zeros(n_rows, np.int64)
        times = np.zeros(n_rows, np.int64)
        buffers = [
            array.ctypes.data_as(POINTER(kind))
            for array, kind in ((values, c_type), (steps, c_int64), (times, c_int64))
        ]
        # Call the C function directly, with one array each for values, steps and times.
        call = _function(
            f"cosim_observer_slave_get_{name}_samples",
            c_int64,
            [type(self._series.ptr()), c_int, c_uint32, c_int64, c_size_t, *map(type, buffers)],
        )
        count = call(self._series.ptr(), slave, variable.value_reference, 0, n_rows, *buffers)
        self._check(count > 0)
        return values[:count], steps[:count]

    def _flag_columns(self, n_rows):
        ends = self._job.plan.layouts["Boolean"].outputs
        columns = {}
        if not ends:
            return []
        self._execution = self._flags = (
            None  # what the observer has written is complete once both are gone
        )
        # The file's name contains the time of its creation; find it by pattern.
        for name, flags in self._flag_names().items():
            flag_file = next(
                f
                for f in self._folder.iterdir()
                if re.fullmatch(rf"{re.escape(name)}_\d+_\d+_\d+\.csv", f.name)
            )
            # Columns of the file: time, step number, then the flags.
            table = np.loadtxt(flag_file, delimiter=",", skiprows=1, ndmin=2)
            for i, flag in enumerate(flags):
                columns[name, flag] = held(table[:n_rows, 2 + i], table[:n_rows, 1], n_rows)
        return [columns[end] for end in ends]

    def _check(self, done):
        if not done:
            from libcosimpy._internal import get_last_error_message

            raise EngineError(get_last_error_message())


class FlagObserver:
    """An observer that writes Boolean variables into a file for each component.

    libcosim's observer of time series refuses them, that of last values reads every variable of an FMU in every step,
    and libcosimpy does not offer this one with a choice of variables.

    Parameters
    ----------
    folder : Path
        Gets the files, NAME_DATE_TIME_MICROSECONDS.csv.
    flags : dict of str to list of str
        Names of variables by component.
    """

    def __init__(self, folder: Path, flags: Mapping[str, list[str]]):
        lines = [
            f'<simulator name={quoteattr(name)} decimationFactor="1">'
            + "".join(f"<variable name={quoteattr(variable)}/>" for variable in variables)
            + "</simulator>"
            for name, variables in flags.items()
        ]
        file = folder / "LogConfig.xml"
        file.write_text(f"<simulators>{''.join(lines)}</simulators>", encoding="utf-8")
        create = _function(
            "cosim_file_observer_create_from_cfg", _observer_pointer(), [c_char_p, c_char_p]
        )
        self._pointer = create(str(folder).encode(), str(file).encode())

    def ptr(self) -> Any:
        """Pointer to it, as libcosimpy's observers have."""
        return self._pointer

    def __del__(self):
        _function("cosim_observer_destroy", c_int, [_observer_pointer()])(self._pointer)


def _function(name, result, arguments):
    from libcosimpy._internal import libcosimc, wrap_function

    return wrap_function(libcosimc(), name, result, arguments)


def _observer_pointer():
    from libcosimpy.CosimObserver import CosimObserver

    return POINTER(CosimObserver)
