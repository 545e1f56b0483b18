"""CVode, the solver of SUNDIALS that FMPy brings, one internal step at a time up to a given time.

BDF of variable order with Newton's method, a dense Jacobian from finite differences, and roots found in every step.
"""

from collections.abc import Callable
from ctypes import byref, c_double, c_int, c_void_p

import numpy as np
from fmpy.sundials import cvode as lib
from fmpy.sundials.cvode_ls import CVodeSetLinearSolver
from fmpy.sundials.libraries import sundials_cvode
from fmpy.sundials.nvector_serial import NV_DATA_S, N_VDestroy_Serial, N_VNew_Serial
from fmpy.sundials.sundials_linearsolver import SUNLinearSolver
from fmpy.sundials.sundials_matrix import SUNMatrix
from fmpy.sundials.sunlinsol_dense import SUNLinSol_Dense
from fmpy.sundials.sunmatrix_dense import SUNDenseMatrix

from shipcosim.cosim.slaves.sundials import Context, free_memory, freeing

BDF = lib.CV_BDF
ONE_STEP = 2
ROOT_RETURN = lib.CV_ROOT_RETURN
RECOVERABLE = 1
UNRECOVERABLE = -1

_set_stop_time = sundials_cvode.CVodeSetStopTime
_set_stop_time.argtypes = [c_void_p, c_double]
_set_stop_time.restype = c_int
_interpolate = sundials_cvode.CVodeGetDky
_interpolate.argtypes = [c_void_p, c_double, c_int, c_void_p]
_interpolate.restype = c_int
_free_solver = freeing("SUNLinSolFree", SUNLinearSolver)
_free_matrix = freeing("SUNMatDestroy", SUNMatrix)


class SolverError(Exception):
    """CVode cannot go on."""


class Cvode:
    """An initial value problem and its solution so far.

    Parameters
    ----------
    n : int
        Number of states; none becomes one that stays as it is.
    derivatives : callable
        Takes (time, pointer to states, pointer to their derivatives, which it fills).
    n_roots : int
        Number of root functions.
    roots : callable
        Takes (time, pointer to states, pointer to the functions' values, which it fills).
    tolerance : float
        Relative; the absolute one is this times a state's nominal value.

    Notes
    -----
    An error of the functions ends the step and is raised by it; returning RECOVERABLE makes CVode try a smaller step.
    """

    def __init__(
        self, n: int, derivatives: Callable, n_roots: int, roots: Callable, tolerance: float
    ):
        self._n = n
        self._derivatives = derivatives
        self._roots = roots
        self._tolerance = tolerance
        self._error: Exception | None = None
        self._memory = None
        self._context = Context()
        context = self._context.arguments
        # SUNDIALS has no empty vector: without states there is one constant dummy.
        self._x, self._absolute, self._between = (
            N_VNew_Serial(max(n, 1), *context) for _ in range(3)
        )
        # NumPy views of the solver's own memory: states are read and set without copies.
        self.states = np.ctypeslib.as_array(NV_DATA_S(self._x), (max(n, 1),))
        self._tolerances = np.ctypeslib.as_array(NV_DATA_S(self._absolute), (max(n, 1),))
        self.states[:], self._tolerances[:] = 0.0, 1.0
        self._states_between = NV_DATA_S(self._between)
        self._matrix = SUNDenseMatrix(max(n, 1), max(n, 1), *context)
        self._solver = SUNLinSol_Dense(self._x, self._matrix, *context)
        # Keep references to the callbacks: C holds only their addresses.
        self._rhs, self._root_function = (
            lib.CVRhsFn(self._evaluate),
            lib.CVRootFn(self._evaluate_roots),
        )
        # BDF is implicit, for stiff ship and machinery models; the Jacobian is dense, by finite
        # differences.
        self._memory = lib.CVodeCreate(BDF, *context)
        self._context.watch(self._memory)
        self._check(lib.CVodeInit(self._memory, self._rhs, 0.0, self._x))
        self._check(lib.CVodeSVtolerances(self._memory, tolerance, self._absolute))
        self._check(CVodeSetLinearSolver(self._memory, self._solver, self._matrix))
        self._check(lib.CVodeSetNoInactiveRootWarn(self._memory))
        if n_roots:
            self._check(lib.CVodeRootInit(self._memory, n_roots, self._root_function))

    def start(self, time: float, nominals: np.ndarray) -> None:
        """Start again at a time from the present `states`; nominal values are an (n,) array."""
        if self._n:
            # Absolute tolerance = relative tolerance times nominal value, as FMI recommends: states
            # differ in size by many powers of ten.
            self._tolerances[:] = self._tolerance * np.abs(nominals)
            self._check(lib.CVodeSVtolerances(self._memory, self._tolerance, self._absolute))
        # A restart also forgets the history of the multistep method, which an event invalidates.
        self._check(lib.CVodeReInit(self._memory, time, self._x))

    def step(self, stop: float) -> tuple[float, bool]:
        """Make one internal step, at most to a time; return the time and if a root was found."""
        reached = c_double()
        self._error = None
        self._check(_set_stop_time(self._memory, stop))
        flag = lib.CVode(self._memory, stop, self._x, byref(reached), ONE_STEP)
        self._check(flag)
        return reached.value, flag == ROOT_RETURN

    def states_at(self, time: float):
        """Pointer to the states at a time within the last step, from the solver's own polynomial."""
        self._check(_interpolate(self._memory, time, 0, self._between))
        return self._states_between

    def close(self) -> None:
        """Free the solver's memory."""
        if self._memory is not None:
            self.states = self._tolerances = np.empty(0)  # the memory that they show is freed
            free_memory(self._memory)
            self._memory = None
            _free_solver(self._solver)
            _free_matrix(self._matrix)
            for vector in (self._x, self._absolute, self._between):
                N_VDestroy_Serial(vector)
            self._context.close()

    def _evaluate(self, time, x, dx, _):
        # The dummy state is constant: its derivative is zero.
        if self._n:
            return self._guarded(self._derivatives, time, NV_DATA_S(x), NV_DATA_S(dx))
        NV_DATA_S(dx)[0] = 0.0
        return 0

    def _evaluate_roots(self, time, x, values, _):
        return self._guarded(self._roots, time, NV_DATA_S(x), values)

    def _guarded(self, function, *arguments):
        # An exception cannot pass through C: keep it and stop the solver; `_check` raises it.
        try:
            return function(*arguments) or 0
        except Exception as error:  # one that left a callback would be printed and forgotten
            self._error = error
            return UNRECOVERABLE

    def _check(self, flag):
        if self._error is not None:
            error = self._error
            self._error = None
            raise error
        if flag < 0:
            message = "The equations cannot be integrated further: a derivative is no number, jumps or grows without limit"
            raise SolverError(f"{message} (code {flag} of CVode).")
