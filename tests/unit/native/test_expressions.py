"""Which values of the C text are written into the next line, and with which parentheses."""

import random
import re

import pytest

from shipcosim.native.expressions import merged


def merged_text(*lines):
    return merged([f"    {line}" for line in lines])[1:]


@pytest.mark.parametrize(
    ("value", "line", "expected"),
    [
        ("m[3] * v1", "const double v9 = v8 + v2;", "const double v9 = m[3] * v1 + v2;"),
        ("m[3] + v1", "const double v9 = v8 * v2;", "const double v9 = (m[3] + v1) * v2;"),
        ("m[3] - v1", "const double v9 = v8 - v2;", "const double v9 = m[3] - v1 - v2;"),
        ("m[3] - v1", "const double v9 = v2 - v8;", "const double v9 = v2 - (m[3] - v1);"),
        ("m[3] / v1", "const double v9 = v2 * v8;", "const double v9 = v2 * (m[3] / v1);"),
        ("sin(v1)", "const double v9 = v2 * v8;", "const double v9 = v2 * sin(v1);"),
        ("-v1", "const double v9 = -v8;", "const double v9 = -(-v1);"),
        ("m[3] + v1", "m[4] = sqrt(v8);", "m[4] = sqrt(m[3] + v1);"),
        ("v1 < v2", "const int v9 = v8 & v3;", "const int v9 = (v1 < v2) & v3;"),
        ("v1 < v2", "const double v9 = v8 ? v1 : v2;", "const double v9 = (v1 < v2) ? v1 : v2;"),
        ("v1 < v2", "if (v8) {", "if (v1 < v2) {"),
        (
            "(v1 < v2) | (v2 != v3)",
            "const int v9 = v8 & v4;",
            "const int v9 = ((v1 < v2) | (v2 != v3)) & v4;",
        ),
        ("(-2.0) * v1", "const double v9 = v8 * v2;", "const double v9 = (-2.0) * v1 * v2;"),
        ("v1 + v2", "const int v9 = v8 < v3;", "const int v9 = v1 + v2 < v3;"),
    ],
)
def test_a_value_that_only_the_next_line_uses_is_written_into_it(value, line, expected):
    kind = "int" if "<" in value else "double"
    assert merged_text(f"const {kind} v8 = {value};", line) == [f"    {expected}"]


@pytest.mark.parametrize(
    "lines",
    [
        ("const double v8 = sin(v1);", "m[3] = v8 * v8;"),
        ("const double v8 = sin(v1);", "m[3] = v1;", "m[4] = v8;"),
        ("const double v8 = sin(v1);", "if (v1 < 0.0) {", "m[4] = v8;"),
        ("const double v8 = sin(v1);", "for (int i = 0; i < 4; i++) v9[i] = m[i] * v8;"),
        # An array holds doubles, a condition is an int.
        ("const int v8 = b1[2];", "const int v9 = v8 & v1;"),
        # C would divide ints.
        ("const double v8 = v1 + v2;", "const double v9 = v8 / v3;"),
        ("const double v8 = v80 + v1;", "const double v9 = v88;"),
        # The line would be too long to read.
        (f"const double v8 = v1{' + v2' * 10};", f"const double v9 = v8{' * v3' * 10};"),
    ],
)
def test_what_else_is_used_keeps_its_variable(lines):
    assert merged_text(*lines) == [f"    {line}" for line in lines]


def computed(lines):
    """Values of all variables of a text without conditions, by name: Python reads its expressions as C does."""
    given = {"m": [0.3, 1.7, -0.9]}
    exec(re.sub(r"(?m)^ *const double |;$", "", "\n".join(lines)), given)
    return {name: value for name, value in given.items() if name.startswith("v")}


def test_the_order_of_operations_stays():
    generator = random.Random(47)
    forms = ["{} + {}", "{} - {}", "{} * {}", "{} / m[1]", "-{}", "min({}, {})"]
    n_lines = 0
    n_written = 0
    for _ in range(300):
        # A stack machine: each value is used once, mostly in the next line.
        stack = ["m[0]", "m[1]"]
        lines = []
        for number in range(8):
            operands = generator.sample([stack.pop(), stack.pop()], k=2)
            right = generator.choice(forms).format(*operands)
            lines.append(f"const double v{number} = {right};")
            stack += generator.sample(["m[0]", "m[1]", "m[2]"], k=2) + [f"v{number}"]
        written = merged(lines)[1:]
        n_lines += len(lines)
        n_written += len(written)
        before = computed(lines)
        after = computed(written)
        assert after == {name: before[name] for name in after}, "\n".join([*lines, "", *written])
    assert n_written < 0.7 * n_lines
