"""One step of a component in Python and compiled: the same numbers, or a reason why it stays in Python."""

import gc
import math
import random
import time as clock
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from shipcosim.angles import wrap
from shipcosim.fmi import Fmu, Input, Output, Parameter
from shipcosim.models.core import maths
from shipcosim.models.core.interpolation import even_table, interp, interp_columns, interp_even
from shipcosim.models.core.memoize import kept
from shipcosim.models.core.sampling import normals, samples_due, tidy_time
from shipcosim.native import CompiledStep, Untraceable, compiled_steps, record_cache
from shipcosim.native.source import DONE, GIVEN_UP

XS, YS, ZS = (0.0, 1.0, 3.0), (2.0, -1.0, 0.5), (0.0, 0.3, 0.9)
TABLE = even_table(np.linspace(-10.0, 10.0, 41), np.sin(np.linspace(-10.0, 10.0, 41)))


@kept(4)
def powers(x):
    return np.array([x, x * x, x**3])


class Pair(NamedTuple):
    a: float
    b: tuple


class Arithmetic(Fmu):
    """Every operation that models use."""

    x = Input("1", "a number")
    y = Input("1", "another")
    flag = Input("1", "a flag", start=False)
    out = Output("1", "what comes of it")
    whole = Output("1", "a whole number", start=0)
    above = Output("1", "a flag", start=False)
    gain = Parameter(2.0, "1", "a factor")
    mode = Parameter(2, "1", "how often")

    def start(self):
        self.pair, self.vector, self.taken = Pair(0.5, (1.0, -2.0)), np.array([1.0, 2.0, 3.0]), 0
        self.out, self.heights = self.x, YS

    def step(self, t, h):
        x, y = self.x, self.y
        a = maths.sin(x) + maths.cos(y) * maths.exp(-x * x) + maths.sqrt(abs(x)) - maths.hypot(x, y)
        a = a + maths.atan2(y, x) + maths.floor(3.0 * x) + wrap(4.0 * x) + maths.clip(y, -0.5, 0.5)
        a = (
            a
            + maths.where(x > y, x, 2.0 * y)
            + x % 0.7
            + (-x) % 0.7
            + x // 0.3
            + (abs(x) + 0.1) ** 1.5
        )
        a = a + interp(x, XS, YS) + sum(interp_columns(y, XS, YS, ZS)) + interp_even(x, TABLE)[0]
        a = a + interp(x, XS, self.heights) + np.log1p(abs(y))
        a = (
            a
            + maths.number(self.flag)
            + maths.minimum(x, y)
            - maths.maximum(x, y)
            + tidy_time(t + h)
        )
        for _ in range(self.mode):
            a = a + self.gain * h
        matrix = np.array([[1.0, 0.2, 0.0], [0.1, 1.0, -0.3], [0.0, 0.4, 0.9]])
        self.vector = matrix @ self.vector * 0.5 + np.sin(powers(x)) * 0.1
        self.pair = Pair(self.pair.a + x, (self.pair.b[1], a))
        if self.flag:
            self.out = a + self.vector.sum()
        else:
            self.out = -a * self.vector[1] + self.pair.b[0]
        due = samples_due(t, 0.07)
        self.repeat(lambda: self.taken < due, self.turn)
        noise = normals("test", 3, self.taken // 2, 2)
        self.out = self.out + noise[1]
        self.whole, self.above = self.taken // 2 + 1, self.out > 0.0

    def turn(self):
        self.out = self.out + 0.1 * self.taken
        self.taken += 1


def compiled(cls, **values):
    """An instance after its start, and what compiled code makes of its step."""
    fmu = cls(cls.__name__)
    for name, value in values.items():
        setattr(fmu, name, value)
    fmu.start()
    return fmu, compiled_steps([fmu], 0.0, 0.1)[0]


def run_in_c(step, t, h):
    import ctypes

    step.memory[-2:] = t, h
    function = ctypes.CFUNCTYPE(ctypes.c_int, *[ctypes.c_void_p] * 4)(step.function.value)
    return function(
        step.memory.ctypes.data,
        step.kept.ctypes.data,
        ctypes.cast(step.call, ctypes.c_void_p),
        None,
    )


def test_every_operation_gives_what_python_gives():
    python, _ = compiled(Arithmetic)
    fmu, step = compiled(Arithmetic)
    assert isinstance(step, CompiledStep), step
    rng = random.Random(4)
    for k in range(400):
        values = {
            "x": rng.uniform(-3.0, 3.0),
            "y": rng.uniform(-3.0, 3.0),
            "flag": rng.random() < 0.5,
        }
        for name, value in values.items():
            setattr(python, name, value)
            step.memory[step.places[name]] = value
        python.step(0.1 * k, 0.1)
        assert run_in_c(step, 0.1 * k, 0.1) == DONE
        step.give_back()
        assert fmu.pair.b == pytest.approx(python.pair.b, rel=1e-12, abs=1e-11)
        assert (fmu.whole, fmu.above, fmu.taken) == (python.whole, python.above, python.taken)
        assert fmu.out == pytest.approx(python.out, rel=1e-12, abs=1e-11)
        assert np.allclose(fmu.vector, python.vector, rtol=1e-13, atol=0.0)
    assert type(fmu.whole) is int and type(fmu.above) is bool and type(fmu.pair) is Pair


def test_a_parameter_that_is_a_quantity_needs_no_new_code(monkeypatch):
    compiled(Arithmetic)
    monkeypatch.setattr("shipcosim.native.component.trace", None)  # nothing is recorded again
    _, step = compiled(Arithmetic, gain=3.5)
    assert isinstance(step, CompiledStep)
    _, step = compiled(Arithmetic, mode=3)
    assert isinstance(step, Untraceable)  # a choice is part of the code


def test_a_whole_number_that_decides_nothing_needs_no_new_code(monkeypatch):
    class Noisy(Fmu):
        """Noise of a seed, added up some times."""

        y = Output("1", "out")
        seed = Parameter(1, "1", "seed")
        turns = Parameter(2, "1", "how often")
        doubled = Parameter(0, "1", "whether it is doubled: 1 for yes")

        def start(self):
            self.y = 0.0

        def step(self, t, h):
            self.y = sum(normals("noise", self.seed, 0, 3)[n] for n in range(self.turns))
            if self.doubled == 1:
                self.y = 2.0 * self.y

    _, step = compiled(Noisy)
    assert isinstance(step, CompiledStep), step
    results = {}
    for values in ({"seed": 7}, {"seed": 7, "turns": 3}, {"seed": 7, "doubled": 1}):
        python, step = compiled(Noisy, **values)
        python.step(0.0, 0.1)
        assert isinstance(step, CompiledStep) and run_in_c(step, 0.0, 0.1) == DONE
        assert step.memory[step.places["y"]] == python.y
        results[python.y] = step
    assert len(results) == 3
    monkeypatch.setattr("shipcosim.native.component.trace", None)
    assert isinstance(
        compiled(Noisy, seed=99)[1], CompiledStep
    )  # the seed is a number like any other
    assert isinstance(compiled(Noisy, turns=1)[1], Untraceable)  # how often is part of the code


def reason(body, **more):
    """Why a component with this step is not compiled."""
    names = {
        "x": Input("1", "in"),
        "y": Output("1", "out"),
        "start": more.pop("start", lambda self: None),
    }
    # The cache keeps records by name: each test has its own class.
    name = f"Odd_{body.__qualname__}"
    cls = type(name, (Fmu,), names | {"step": body, "__doc__": "Odd."} | more)
    _, step = compiled(cls)
    assert isinstance(step, Untraceable)
    return str(step)


def test_a_refusal_is_kept_for_the_same_numbers(monkeypatch):
    def body(self, t, h):
        self.y = self.x + clock.perf_counter()

    said = reason(body)
    traced = []
    monkeypatch.setattr("shipcosim.native.component.trace", lambda *given: traced.append(given))
    assert reason(body) == said
    assert traced == []
    # Other numbers may take another way.
    reason(body, start=lambda self: setattr(self, "x", 2.0))
    assert len(traced) == 1


def test_what_grows_is_named():
    def start(self):
        self.seen = []

    def body(self, t, h):
        self.seen = [*self.seen, self.x]
        self.y = self.seen[0]

    assert "its state changes its shape: seen" in reason(body, start=start)


def test_what_is_no_arithmetic_is_not_called_and_named():
    def body(self, t, h):
        self.y = clock.perf_counter()

    assert "it calls time.perf_counter, which is no arithmetic" in reason(body)

    def body_with_print(self, t, h):
        print("this must not be seen")
        self.y = self.x

    assert "it calls builtins.print" in reason(body_with_print)

    def body_with_file(self, t, h):
        self.y = float(len([*Path().glob("*.npz")]))

    assert "it reads files in a step" in reason(body_with_file)


def test_what_the_garbage_collector_calls_hides_no_call_of_the_model():
    class Closed:
        def __init__(self):
            self.itself = self

        def __del__(self):
            clock.perf_counter()

    def body(self, t, h):
        values = [[self.x] for _ in range(100)]
        print("this must not be seen")
        self.y = values[0][0]

    threshold = gc.get_threshold()
    gc.set_threshold(20)
    left = [Closed() for _ in range(100)]
    try:
        del left
        assert "it calls builtins.print" in reason(body)
    finally:
        gc.set_threshold(*threshold)


def test_a_text_made_of_a_number_is_named():
    def body(self, t, h):
        self.y, self.text = self.x, f"{self.x}"

    assert "text" in reason(body, start=lambda self: setattr(self, "text", ""))


def test_a_float_that_is_asked_for_is_named():
    def body(self, t, h):
        self.y = math.sin(self.x)

    assert "asks for a value as a float: use number(...)" in reason(body)


def test_too_many_ways_are_named_with_the_line():
    def body(self, t, h):
        for k in range(12):
            if self.x > 0.1 * k * t:
                self.y = self.y + 1.0

    assert "ways through a step, most of them by line" in reason(body)


def test_a_loop_that_changes_a_local_variable_is_named():
    def body(self, t, h):
        seen = [0.0]

        def turn():
            seen[0] = seen[0] + self.x
            self.k = self.k - 1.0

        self.k = 3.0 + maths.floor(self.x * 0.0)
        self.repeat(lambda: self.k > 0.0, turn)
        self.y = seen[0]

    assert "keeps a value of a loop or of another way in a variable of its own" in reason(
        body, start=lambda self: setattr(self, "k", 0.0)
    )


def test_an_error_of_the_model_leaves_the_memory_and_the_step_to_python():
    class Strict(Fmu):
        """Refuses what is negative."""

        x = Input("1", "in", start=1.0)
        y = Output("1", "out")

        def start(self):
            self.y = self.x

        def step(self, t, h):
            if self.x < 0.0:
                raise ValueError("x is negative")
            self.y = 1.0 / self.x

    _, step = compiled(Strict)
    assert isinstance(step, CompiledStep), step
    assert run_in_c(step, 0.0, 0.1) == DONE
    for wrong in (-1.0, 0.0):  # what Python refuses, and what it divides by
        step.memory[step.places["x"]] = wrong
        before = step.memory.copy()
        assert run_in_c(step, 0.0, 0.1) == GIVEN_UP
        assert step.memory[step.places["y"]] == before[step.places["y"]]


DAMAGES = {
    "text": lambda content: b"nothing",
    "empty": lambda content: b"",
    "cut": lambda content: content[: len(content) // 2],
    "noise": lambda content: bytes(range(256)) * 20,
    **{
        f"byte at {share}": lambda content, share=share: (
            content[: int(share * len(content))]
            + bytes([content[int(share * len(content))] ^ 0xFF])
            + content[int(share * len(content)) + 1 :]
        )
        for share in (0.0, 0.02, 0.3, 0.6, 0.99)
    },
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_cache_that_is_spoilt_is_made_again(tmp_path, monkeypatch, damage):
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path))
    record_cache._READ.clear()
    compiled(Arithmetic)
    records = list((tmp_path / "native").glob("*.record"))
    assert records
    for path in records:
        path.write_bytes(DAMAGES[damage](path.read_bytes()))
        assert record_cache._records_in(path) == []
    record_cache._READ.clear()
    _, step = compiled(Arithmetic)
    assert isinstance(step, CompiledStep)


def test_records_follow_the_code_that_writes_them():
    assert record_cache.OWN_CODE == record_cache._own_code()
