"""Compare an FMU in C with the one in Python: start and steps, random parameters and inputs."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from shipcosim.native.checking import within_bounds
from shipcosim.native.export.targets import TARGETS, own_target
from shipcosim.native.export.text import NOT_FOR_THESE
from shipcosim.native.symbols import Untraceable

STEPS = 40
"""Steps that are compared, for each set of parameters."""

LARGEST = 1e-9
"""Difference of a variable, over its size or 1, above which an FMU is refused."""

SHARES = 1e-3, 1e-2, 0.1, 1.0
"""Size of random inputs in each round, over `SIZES`: inputs for a ship are too large for a boat."""

FASTEST = 50.0
"""Speed of an output beyond which a round ends. [m/s, rad/s]"""

SPREAD = 0.02
"""Standard deviation of random parameters, over the example's."""

SIZES = {"N": 2e4, "N.m": 1e5, "W": 1e5, "rad": 0.7, "rpm": 60.0, "m": 3.0, "s": 1.0, "Pa": 1e3}
"""Size of random inputs by unit; 0.5 for other units."""


def refuse_other_results(
    cls: Any, library: bytes, guid: str, examples: Sequence[Mapping[str, Any]]
) -> None:
    """Start and step the FMU in Python and in C, from the same random numbers.

    Parameters
    ----------
    cls : type of Fmu
        The class.
    library : bytes
        The FMU's binary for this machine.
    guid : str
        Of the model description.
    examples : sequence of mapping of str to value
        Parameters of each variant.

    Raises
    ------
    Untraceable
        A variable differs by more than `LARGEST`, with its name, the step and both values; or one of them refuses what
        the other takes.
    """
    # A fixed seed, so that a build succeeds or fails in the same way each time.
    random = np.random.default_rng(1)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        path = Path(folder, f"model{TARGETS[own_target()].suffix}")
        path.write_bytes(library)
        loaded = ctypes.CDLL(str(path))
        # The first round uses the example as it is; the others draw parameters near it. Each round
        # has larger inputs.
        for example in examples:
            for number in range(len(SHARES)):
                _compare_run(
                    cls,
                    loaded,
                    guid,
                    _near(cls, example, random if number else None),
                    random,
                    number,
                )


def _compare_run(cls, library, guid, parameters, random, number):
    python = cls("it")
    compiled = _Compiled(cls, library, guid)
    inputs = {v.name: v.start for v in cls.variables if v.causality == "input"}
    is_near = number > 0
    try:
        # A start time other than zero finds code that takes it for zero.
        time = float(random.integers(0, 3)) * 100.0
        python.setup_experiment(time)
        compiled.setup(time)
        _set(python, parameters)
        compiled.set(parameters)
        # Start values of inputs matter too: the start may compute outputs from them.
        _draw(cls, inputs, random, SHARES[number])
        _set(python, inputs)
        compiled.set(inputs)
        if not _both(
            lambda: _initialise(python), compiled.initialise, "at the start", compiled, is_near
        ):
            return
        _compare(cls, python, compiled, "at the start")
        # Each step gets new inputs, both sides the same. The states go on by themselves, so errors
        # of the state show too.
        h = cls.default_step_size
        for step_number in range(STEPS):
            _draw(cls, inputs, random, SHARES[number])
            _set(python, inputs)
            compiled.set(inputs)
            step = f"in step {step_number + 1}"
            t = time + step_number * h
            if not _both(
                lambda t=t: python.advance(t, h),
                lambda t=t: compiled.step(t, h),
                step,
                compiled,
                is_near,
            ):
                return
            # Beyond this speed the model has diverged: rounding grows and a comparison says
            # nothing.
            if _is_lost(cls, python):
                return
            _compare(cls, python, compiled, step)
    finally:
        compiled.free()


def _both(in_python, in_c, when, compiled, is_near) -> bool:
    """Run an action in both; true if it worked in both. Both must refuse the same."""
    try:
        in_python()
        refused = ""
    except Exception as error:
        refused = f"{type(error).__name__}: {error}"
    done = in_c()
    # Random parameters may need a variant that was not compiled. The FMU refuses them, as it
    # should.
    if not done and NOT_FOR_THESE in compiled.message and is_near:
        return False
    if done == (not refused):
        return done
    who = ("Python", "C", refused) if refused else ("C", "Python", compiled.message)
    raise Untraceable(f"{when} {who[0]} fails and {who[1]} does not: {who[2][:300]}")


def _compare(cls, python, compiled, when):
    for name, result in compiled.outputs().items():
        # Relative above one, absolute below: outputs near zero have no relative error.
        expected = float(getattr(python, name))
        if abs(result - expected) > LARGEST * max(abs(expected), 1.0):
            raise Untraceable(f"{when} {name} is {result:.12g} in C and {expected:.12g} in Python")


def _near(cls, example, random) -> dict[str, Any]:
    """All parameters of an example; with a random generator, near them and within their bounds."""
    parameters = {}
    for v in cls.variables:
        if v.causality != "parameter":
            continue
        value = example.get(v.name, v.start)
        if (
            # Only real parameters vary: others select code. Omitted and unlimited ones keep their
            # meaning.
            random is not None
            and v.type == "Real"
            and not v.is_left_out(value)
            and abs(value) < 1e12
        ):
            value = within_bounds(v, value * (1.0 + SPREAD * random.standard_normal()))
        parameters[v.name] = value
    return parameters


def _is_lost(cls, python):
    """True if an output moves so fast that rounding errors become visible."""
    fast = [v.name for v in cls.variables if v.causality == "output" and v.unit in ("m/s", "rad/s")]
    return any(abs(getattr(python, name)) > FASTEST for name in fast)


def _draw(cls, inputs, random, share):
    """Change the inputs at random: numbers drift around their start, flags change seldom."""
    for v in cls.variables:
        if v.causality != "input":
            continue
        value = inputs[v.name]
        if v.type == "Real":
            # An input of 1e12 and more means unlimited; its random value gets the size of real
            # power, 1e5.
            size = SIZES.get(v.unit, 0.5) if abs(v.start) < 1e12 else 1e5
            if abs(v.start) >= 1e12 and random.random() < 0.9:
                continue  # plenty of power and the like stays so, mostly
            # First-order autoregressive noise about the start, so that inputs move as signals do.
            # The memory of 0.9 a step keeps them bounded.
            start = v.start if abs(v.start) < 1e12 else 2e5
            value = (
                0.9 * (value - start if abs(value) < 1e12 else 0.0)
                + share * size * random.standard_normal()
            )
            inputs[v.name] = within_bounds(v, start + value)
        elif v.type == "Boolean":
            inputs[v.name] = bool(value) ^ bool(random.random() < 0.04)
        elif v.type == "Integer":
            inputs[v.name] = int(value)


def _initialise(python):
    python.enter_initialization_mode()
    python.exit_initialization_mode()


def _set(python, values):
    vars(python).update(values)


class _Compiled:
    """An instance of the C FMU, called through the functions of FMI."""

    def __init__(self, cls, library, guid):
        self._library = library
        self.message = ""
        # FMI sets and gets values by type, so group the variables by type once.
        self._of_type = {
            kind: [
                (v.name, reference) for reference, v in enumerate(cls.variables) if v.type == kind
            ]
            for kind in ("Real", "Integer", "Boolean", "String")
        }
        self._outputs = {v.name for v in cls.variables if v.causality == "output"}
        self._callbacks = _Callbacks(_LOGGER(self._log), None, None, None, None)
        library.fmi2Instantiate.restype = ctypes.c_void_p
        callbacks = ctypes.byref(self._callbacks)
        self._o = ctypes.c_void_p(
            library.fmi2Instantiate(b"it", 1, guid.encode(), b"", callbacks, 0, 0)
        )
        if not self._o:
            raise Untraceable(f"the compiled FMU cannot be instantiated: {self.message}")

    def setup(self, time):
        number = ctypes.c_double
        self._library.fmi2SetupExperiment(self._o, 0, number(0.0), number(time), 0, number(0.0))

    def set(self, values):
        for kind, variables in self._of_type.items():
            settable = [
                (reference, values[name]) for name, reference in variables if name in values
            ]
            if settable:
                given = [value.encode() if kind == "String" else value for _, value in settable]
                self._done(
                    getattr(self._library, f"fmi2Set{kind}")(
                        *self._lists(kind, [r for r, _ in settable], given)
                    )
                )

    def outputs(self) -> dict[str, float]:
        numbers = {}
        for kind, variables in self._of_type.items():
            wanted = [(name, reference) for name, reference in variables if name in self._outputs]
            if wanted and kind != "String":
                o, references, n, values = self._lists(
                    kind, [r for _, r in wanted], [0] * len(wanted)
                )
                self._done(getattr(self._library, f"fmi2Get{kind}")(o, references, n, values))
                numbers |= {
                    name: float(value) for (name, _), value in zip(wanted, values, strict=True)
                }
        return numbers

    def initialise(self) -> bool:
        self._library.fmi2EnterInitializationMode(self._o)
        return self._library.fmi2ExitInitializationMode(self._o) == 0

    def step(self, time, step_size) -> bool:
        return (
            self._library.fmi2DoStep(self._o, ctypes.c_double(time), ctypes.c_double(step_size), 1)
            == 0
        )

    def free(self):
        self._library.fmi2FreeInstance(self._o)

    def _lists(self, kind, references, values):
        n = len(references)
        made = {"Real": ctypes.c_double, "String": ctypes.c_char_p}.get(kind, ctypes.c_int)
        return self._o, (ctypes.c_uint * n)(*references), ctypes.c_size_t(n), (made * n)(*values)

    def _done(self, status):
        if status != 0:
            raise Untraceable(f"the compiled FMU refuses what Python takes: {self.message}")

    def _log(self, environment, name, status, category, text, words):
        self.message = (words or b"").decode(errors="replace")


_LOGGER = ctypes.CFUNCTYPE(
    None,
    ctypes.c_void_p,
    ctypes.c_char_p,
    ctypes.c_int,
    ctypes.c_char_p,
    ctypes.c_char_p,
    ctypes.c_char_p,
)


class _Callbacks(ctypes.Structure):
    _fields_ = [
        ("logger", _LOGGER),
        ("allocate", ctypes.c_void_p),
        ("free", ctypes.c_void_p),
        ("step_finished", ctypes.c_void_p),
        ("environment", ctypes.c_void_p),
    ]
