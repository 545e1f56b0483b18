"""Loops, choices and maps in one another, as Python and as compiled code: programs drawn at random, and what is refused."""

import random

import pytest
from native.test_steps import compiled, reason, run_in_c

from shipcosim.fmi import Fmu, Input, Output
from shipcosim.models.core.maths import choose, mapped, repeat, row_of, where
from shipcosim.native import CompiledStep
from shipcosim.native.source import DONE, GIVEN_UP


def drawn(rng, depth):
    """A function of two numbers: arithmetic, and parts that hold functions of their own."""
    a, b = (rng.uniform(-1.5, 1.5) for _ in range(2))
    if depth == 0:
        return lambda x, y: a * x - b * y + 0.3 * x * y
    first, second = (drawn(rng, depth - 1) for _ in range(2))

    def chosen(x, y):
        return choose(x > a * y, lambda: first(x, b), lambda: second(a, y))

    def forked(x, y):
        z = chosen(x, y)
        if z > b:
            return first(z, y)
        return where(y > 0.0, second(x, z), z)

    def repeated(x, y):
        count, x, y = repeat(
            lambda state: (state[0] < 3) & (abs(state[1]) < 5.0),
            lambda state: (state[0] + 1, first(state[2], a), second(state[1], state[2])),
            (0, x, y),
        )
        return x - y + count

    def summed(x, y):
        rows = mapped(lambda u, v: (first(u, v), second(v, u)), (x, y, x * y), (a, b, x - y))
        return sum(u - 0.5 * v for u, v in rows)

    def looked_up(x, y):
        pairs = ((x, a), (first(x, y), b), (y, x))
        u, v = row_of(pairs, where(x > y, 1, -1))
        return u * v

    return rng.choice([chosen, forked, repeated, summed, looked_up])


@pytest.mark.parametrize("seed", range(24))
def test_parts_in_one_another_give_what_python_gives(seed, tmp_path, monkeypatch):
    # A record is found by the name of its class, which is that of all seeds.
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path))
    function = drawn(random.Random(seed), 1 + seed % 3)

    class Program(Fmu):
        """A drawn program with a state."""

        x = Input("1", "a number")
        y = Input("1", "another")
        out = Output("1", "what comes of it")

        def start(self):
            self.out = 0.0

        def step(self, t, h):
            self.out = function(self.x, self.y) + 0.1 * self.out

    python, _ = compiled(Program)
    fmu, step = compiled(Program)
    assert isinstance(step, CompiledStep), step
    rng = random.Random(100 + seed)
    found = set()
    for k in range(60):
        python.x, python.y = rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0)
        for name in ("x", "y"):
            step.memory[step.places[name]] = getattr(python, name)
        python.step(0.1 * k, 0.1)
        assert run_in_c(step, 0.1 * k, 0.1) == DONE
        assert step.memory[step.places["out"]] == python.out
        found.add(python.out)
    assert len(found) > 30  # it depends on what goes in


def test_an_error_on_one_side_leaves_the_step_to_python():
    class OneSided(Fmu):
        """Has no answer for what is negative."""

        x = Input("1", "in", start=1.0)
        y = Output("1", "out")

        def start(self):
            self.y = 0.0

        def step(self, t, h):
            self.y = choose(self.x > 0.0, lambda: 2.0 * self.x, self.refuse)

        def refuse(self):
            raise ValueError("x is negative")

    _, step = compiled(OneSided)
    assert isinstance(step, CompiledStep), step
    assert run_in_c(step, 0.0, 0.1) == DONE and step.memory[step.places["y"]] == 2.0
    step.memory[step.places["x"]] = -1.0
    assert run_in_c(step, 0.0, 0.1) == GIVEN_UP and step.memory[step.places["y"]] == 2.0


def test_two_shapes_of_a_choice_are_named():
    def body(self, t, h):
        pair = choose(self.x > 0.5, lambda: (self.x, 1.0), lambda: (self.x,))
        self.y = pair[0]

    assert "its values have two shapes" in reason(body)


def test_a_side_that_keeps_its_value_for_later_is_named():
    def body(self, t, h):
        seen = [0.0]

        def noted():
            seen[0] = 2.0 * self.x
            return self.x

        self.y = choose(self.x > 0.5, noted, lambda: 0.0) + seen[0]

    assert "keeps a value of a loop or of another way" in reason(body)


def test_text_grows_with_the_number_of_questions_and_not_with_its_power():
    from shipcosim.native.source import source_of
    from shipcosim.native.trace import shape_of, trace

    def lines(questions):
        class Asking(Fmu):
            """Adds up answers."""

            x = Input("1", "in", start=1.0)
            y = Output("1", "out")

            def start(self):
                self.y = 0.0

            def step(self, t, h):
                total = self.x
                for k in range(questions):
                    at = total
                    total = choose(at > k, lambda at=at: at * 1.5, lambda at=at: at + 0.5)
                self.y = total

        fmu = Asking("asking")
        fmu.start()
        return source_of(trace(fmu, shape_of(fmu), 0.0, 0.1)).count("\n")

    few, some, many = (lines(n) for n in (10, 20, 40))
    assert many - some == 2 * (some - few) < 200
