"""C text of a recorded step: one function that changes an array of doubles in place."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from shipcosim.native.array_statements import (
    FEWEST,
    Statement,
    Term,
    goes_on,
    loop_of,
    write_in_runs,
)
from shipcosim.native.blocks import Block, RecordedLoop, ends, results_of
from shipcosim.native.error_texts import values_in_text
from shipcosim.native.expressions import merged
from shipcosim.native.number_rows import Flat
from shipcosim.native.recording import Recording
from shipcosim.native.symbols import Symbol, kind_of
from shipcosim.native.trace import Step

DONE = 0
GIVEN_UP = 1
"""What the function returns: the step is done; nothing has changed, Python must do it."""

HEAD = """\
#include <math.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef int (*Call)(void *host, int number, const double *arguments, double *kept);

static inline double remainder_of(double a, double b) {
    double m = fmod(a, b);
    if (m != 0.0) return ((b < 0.0) != (m < 0.0)) ? m + b : m;
    return copysign(0.0, b);
}

static inline double floor_division(double a, double b) {
    double m = fmod(a, b), d = (a - m) / b, whole;
    if (m != 0.0 && ((b < 0.0) != (m < 0.0))) d -= 1.0;
    if (d == 0.0) return copysign(0.0, a / b);
    whole = floor(d);
    return d - whole > 0.5 ? whole + 1.0 : whole;
}

static inline double rounded(double x, double scale) { return rint(x * scale) / scale; }

static double interpolated(double x, const double *xs, const double *ys, int n) {
    int low = 0, high = n - 1;
    if (x <= xs[0]) return ys[0];
    if (x >= xs[n - 1]) return ys[n - 1];
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (x < xs[middle]) high = middle; else low = middle;
    }
    return ys[low] + (ys[low + 1] - ys[low]) * (x - xs[low]) / (xs[low + 1] - xs[low]);
}
"""

FUNCTIONS = ("sin", "cos", "tan", "exp", "log", "log1p", "sqrt", "tanh", "floor", "ceil")
FUNCTIONS += ("asin", "acos", "atan", "sinh", "cosh", "log10")
UNARY = {
    "neg": "-{}",
    "not": "!{}",
    "abs": "fabs({})",
    "number": "(double){}",
    "whole": "trunc({})",
} | {name: f"{name}({{}})" for name in FUNCTIONS}
BINARY = {
    op: f"{{}} {op} {{}}"
    for op in ("+", "-", "*", "/", "<", "<=", ">", ">=", "==", "!=", "&", "|", "^")
} | {
    "**": "pow({}, {})",
    "%": "remainder_of({}, {})",
    "//": "floor_division({}, {})",
    "atan2": "atan2({}, {})",
    "copysign": "copysign({}, {})",
}


ARRAYS = {"carried": "c", "after": "c", "joined": "b", "mapped": "r"}
"""Letters of the arrays in which loops, branches and maps hold their numbers."""
OVERWRITTEN = ("load", "kept", "carried")
"""Values that lie where results are written."""


def source_of(step: Step) -> str:
    """Write the C text of a component with the function ``step``.

    Its arguments are the memory, as `Step` lays it out; the results of functions that stay in Python, one behind the
    other, each behind the arguments that it belongs to; the function that calls them, and the host it belongs to.
    """
    return Writer(step).text()


def kept_sizes(recording: Recording) -> list[tuple[int, int]]:
    """Number of arguments and results of each function that stays in Python."""
    return [(len(call.changing), len(Flat(call.result).numbers)) for call in recording.calls]


class Writer:
    """Writes the blocks of a recording as C."""

    apart: tuple[str, ...] = ("guard", "call", "loop", "carried", "branch", "map", "index", "array")
    """Values without an assignment of their own."""

    def __init__(self, step: Step):
        self.step = step
        self.recording = step.recording
        self.sizes = kept_sizes(step.recording)
        # Each call owns a piece of `k`: its arguments, then its results.
        firsts = np.cumsum([0, *(a + b for a, b in self.sizes)]).tolist()
        self.arguments = firsts[:-1]
        self.results = [first + size[0] for first, size in zip(firsts, self.sizes, strict=False)]
        # Only values that a result depends on are written; this keeps the C text short.
        self.used = _used(step)
        # Of the numbers that loops, branches and maps hold, only those that are used have a place.
        used_places: dict[str, set[int]] = defaultdict(set)
        for block in _all_blocks(step.root, step.recording):
            for symbol in block.values:
                if symbol.op in ARRAYS and symbol.number in self.used:
                    number, place, *_ = symbol.operands
                    used_places[f"{ARRAYS[symbol.op]}{number}"].add(place)
        self._places = {array: sorted(places) for array, places in used_places.items()}
        self._elements: dict[int, Term] = {}  # where a value is found that has no variable
        self._stored = _stored(step)
        self.lines: list[str] = []

    def text(self) -> str:
        # Constant tables stand before the function.
        tables = self._tables()
        self._block(self.step.root, 1, self._finish)
        parameters = "double *restrict m, double *restrict k, Call call, void *host"
        body = "\n".join(merged(self.lines))
        unused = "    (void)m; (void)k; (void)call; (void)host;"
        return "\n".join(
            [HEAD, *tables, "", f"EXPORT int step({parameters}) {{", unused, body, "}", ""]
        )

    def _tables(self, indent: str = "") -> list[str]:
        """Constant tables, a line each."""
        return [
            f"{indent}static const double table_{number}[] = {{{', '.join(map(literal, table.tolist()))}}};"
            for number, table in enumerate(self.recording.tables)
        ]

    def _put(self, depth, line):
        self.lines.append("    " * depth + line)

    def _block(self, block: Block, depth: int, finish):
        # Values in order, then the fork. Each branch goes on to its own end, so nothing has to be
        # joined.
        self._values([symbol for symbol in block.values if symbol.number in self.used], depth)
        if block.condition is None:
            finish(block.result, depth)
            return
        self._put(depth, f"if ({self.operand(block.condition)}) {{")
        self._block(_of(block.yes), depth + 1, finish)
        self._put(depth, "} else {")
        self._block(_of(block.no), depth + 1, finish)
        self._put(depth, "}")

    def _finish(self, result, depth):
        # Where Python raises an error, C gives up and Python raises it.
        if not isinstance(result, list):
            self._put(depth, self._fail(result))
            return
        # A sum is finite only if all terms are: one test for all outputs. Nothing is written before
        # it.
        checked = [self.operand(number) for place, number in result if place in self.step.outputs]
        if checked:
            self._put(depth, f"if (!isfinite({' + '.join(checked)})) return {GIVEN_UP};")
        self._write("m", ((self._place(place), number) for place, number in result), depth)
        self._put(depth, f"return {DONE};")

    def _fail(self, error: Exception) -> str:
        """Write what follows where Python raises an error."""
        return f"return {GIVEN_UP};"

    def _other(self, symbol: Symbol, expected: Any) -> str:
        """Write what follows where a guarded whole number differs."""
        return f"return {GIVEN_UP};"

    def _place(self, place: int) -> int:
        """Place of a number in the memory."""
        return place

    def operand(self, value: Any) -> str:
        """A symbol or number in C."""
        return self.term(value).text

    def term(self, value: Any) -> Term:
        """Where the C text finds a symbol or number."""
        if isinstance(value, Symbol):
            if value.op == "index":
                return Term(f"i{value.operands[0]}")
            return self._elements.get(value.number) or Term(_name(value))
        return Term(literal(value), is_literal=True)

    def _values(self, symbols: Sequence[Symbol], depth: int):
        """Write values, those that make an array as a loop."""
        plain: list[Symbol] = []
        for symbol in symbols:
            # What lies in the memory anyway needs no variable.
            if (place := self._place_of(symbol)) is not None:
                self._elements[symbol.number] = place
            elif symbol.op in self.apart:
                self._assignments(plain, depth)
                plain = []
                self._value(symbol, depth)
            else:
                plain.append(symbol)
        self._assignments(plain, depth)

    def _assignments(self, symbols: Sequence[Symbol], depth: int):
        def write(run, numbers):
            for number, term in zip(numbers, self._put_run(run, depth), strict=False):
                self._elements[number] = term

        write_in_runs(symbols, self._statement, write)

    def _put_run(self, run: Sequence[Statement], depth: int) -> list[Term]:
        """Write equal statements; returns where their values are, if these have no variables of their own."""
        if len(run) < FEWEST:
            for statement in run:
                self._put(depth, _declared(statement))
            return []
        lines, elements = loop_of(run)
        for line in lines:
            self._put(depth, line)
        return elements

    def _write(self, array: str, numbers: Iterable[tuple[int, Any]], depth: int):
        """Write symbols and numbers to places of an array, in any order."""
        statements = [
            Statement("", "", f"{array}[{{}}] = {{}}", (Term("", place), self.term(number)))
            for place, number in numbers
        ]
        # What comes from one array is written together. All values are known by now, so the order
        # does not matter.
        run: list[Statement] = []
        for statement in sorted(statements, key=lambda statement: statement.terms[1].base):
            if run and not goes_on(run, statement):
                self._put_run(run, depth)
                run = []
            run.append(statement)
        self._put_run(run, depth)

    def _value(self, symbol: Symbol, depth):
        """Write a value that is more than an assignment."""
        op = symbol.op
        operands = symbol.operands
        if op == "guard":
            given, expected = operands
            self._put(
                depth,
                f"if ({self.operand(given)} != {self.operand(expected)}) {self._other(given, expected)}",
            )
        elif op == "call":
            self._call(operands, depth)
        elif op == "loop":
            self._loop(self.recording.loops[operands[0]], operands[0], depth)
        elif op == "branch":
            self._branch(operands[0], depth)
        elif op == "map":
            self._map(operands[0], depth)
        elif op == "array":
            self._put(depth, f"double a{symbol.number}[{len(operands)}];")
            self._write(f"a{symbol.number}", enumerate(operands), depth)

    def _place_of(self, symbol: Symbol) -> Term | None:
        """Where a value lies in the memory until the results are written; None where it has to be kept."""
        # C computes with whole numbers for truth values, and a result may be written over its source.
        is_written_over = symbol.number in self._stored and symbol.op in OVERWRITTEN
        if symbol.kind == "b" or is_written_over:
            return None
        return self._in_memory(symbol)

    def _in_memory(self, symbol: Symbol) -> Term | None:
        """Where a value lies in the memory before the step, or behind a branch; None where it is computed."""
        if symbol.op == "load":
            return Term("m", self._place(symbol.operands[0]))
        if symbol.op == "kept":
            call, place = symbol.operands
            return Term("k", self.results[call] + place)
        if symbol.op in ARRAYS:
            number, place, *row = symbol.operands
            array = f"{ARRAYS[symbol.op]}{number}"
            places = self._places[array]
            # The results of a map lie row by row.
            before = row[0] * len(places) if row else 0
            return Term(array, before + places.index(place))
        return None

    def _statement(self, symbol: Symbol) -> Statement:
        """The assignment of a value."""
        template, operands = self._expression(symbol)
        terms = tuple(
            operand if isinstance(operand, Term) else self.term(operand) for operand in operands
        )
        return Statement(_name(symbol), "int" if symbol.kind == "b" else "double", template, terms)

    def _expression(self, symbol: Symbol) -> tuple[str, Sequence[Any]]:
        """C text of a value with a pair of braces for each operand, and the operands."""
        op = symbol.op
        operands = symbol.operands
        if (element := self._in_memory(symbol)) is not None:
            return f"{element.base}[{{}}]", [Term("", element.index)]
        # A row of a table: its elements lie row by row.
        if op == "row":
            index, table, width, column = operands
            return f"table_{table}[(long){{}} * {width} + {{}}]", [index, Term("", column)]
        if op == "array_row":
            index, array, width, column = operands
            return f"a{array.number}[(long){{}} * {width} + {{}}]", [index, Term("", column)]
        if op in ("load_row", "kept_row"):
            index, (*call, place), width, column = operands
            base = (
                f"m[{self._place(place)}"
                if op == "load_row"
                else f"k[{self.results[call[0]] + place}"
            )
            return f"{base} + (long){{}} * {width} + {{}}]", [index, Term("", column)]
        if op == "interp":
            x, first, second, n = operands
            return f"interpolated({{}}, table_{first}, table_{second}, {n})", [x]
        if op == "where":
            return "{} ? {} : {}", operands
        if op == "round":
            return f"rounded({{}}, 1e{operands[1]})", operands[:1]
        # All others are one C operator or function.
        return (UNARY if len(operands) == 1 else BINARY)[op], operands

    def _call(self, operands, depth):
        number, *arguments = operands
        first = self.arguments[number]
        # The cached result holds while all arguments are equal. NaN is never equal.
        same = (
            " || ".join(f"k[{first + i}] != {self.operand(a)}" for i, a in enumerate(arguments))
            or "0"
        )
        self._put(depth, f"if ({same}) {{")
        self._write("k", ((first + i, a) for i, a in enumerate(arguments)), depth + 1)
        # After a failed call the arguments must not look valid: NaN forces the next call.
        again = f"k[{first}] = NAN; " if arguments else ""
        self._put_call(number, f"k + {first}, k + {self.results[number]}", again, depth + 1)
        self._put(depth, "}")

    def _put_call(self, number: int, where: str, again: str, depth: int):
        """Write a call with its place for arguments and results; `again` follows where it fails."""
        self._put(depth, f"if (call(host, {number}, {where})) {{ {again}return {GIVEN_UP}; }}")

    def _loop(self, loop: RecordedLoop, number, depth):
        # Carried values that nobody reads need no place.
        array = f"c{number}"
        places = self._places[array]
        self._put(depth, f"double {array}[{len(places)}];")
        self._write(array, ((k, loop.start[place]) for k, place in enumerate(places)), depth)
        # The condition is a block of statements, so C loops forever and breaks where it fails.
        self._put(depth, "for (;;) {")
        # A value that moves to another place is kept until all are written.
        for symbol in loop.carried:
            if symbol.number in self.used and self._place_of(symbol) is None:
                self._put(depth + 1, _declared(self._statement(symbol)))
        self._put(depth + 1, "int going;")
        self._block(loop.going, depth + 1, self._decide)
        # The body ends by writing the carried values that it has changed.
        self._put(depth + 1, "if (!going) break;")

        def turn(result, inner):
            if isinstance(result, Exception):
                self._put(inner, self._fail(result))
                return
            changed = (
                (k, result.numbers[place])
                for k, place in enumerate(places)
                if result.numbers[place] is not loop.carried[place]
            )
            self._write(array, changed, inner)

        self._block(loop.body, depth + 1, turn)
        self._put(depth, "}")

    def _branch(self, number, depth):
        branch = self.recording.branches[number]
        places = self._places[f"b{number}"]
        self._put(depth, f"double b{number}[{len(places)}];")
        finish = self._results_to(f"b{number}", places)
        self._put(depth, f"if ({self.operand(branch.condition)}) {{")
        self._block(branch.yes, depth + 1, finish)
        self._put(depth, "} else {")
        self._block(branch.no, depth + 1, finish)
        self._put(depth, "}")

    def _map(self, number, depth):
        places = self._places[f"r{number}"]
        count = self.recording.maps[number].count
        self._put(depth, f"double r{number}[{count * len(places)}];")
        self._put(depth, f"for (int i{number} = 0; i{number} < {count}; i{number}++) {{")
        # The results of a row lie behind those of the row before.
        self._put(depth + 1, f"double *row = r{number} + {len(places)} * i{number};")
        self._block(self.recording.maps[number].body, depth + 1, self._results_to("row", places))
        self._put(depth, "}")

    def _results_to(self, array, places):
        """What ends a way of a part: its results at some places go to an array."""

        def finish(result, depth):
            if isinstance(result, Exception):
                self._put(depth, self._fail(result))
            else:
                numbers = ((k, result.numbers[place]) for k, place in enumerate(places))
                self._write(array, numbers, depth)

        return finish

    def _decide(self, result, depth):
        if isinstance(result, Exception):
            self._put(depth, self._fail(result))
        else:
            self._put(depth, f"going = {self.operand(result)};")


def _of(block: Block | None) -> Block:
    assert block is not None
    return block


def _name(symbol):
    return f"v{symbol.number}"


def _declared(statement: Statement) -> str:
    """The whole statement: the declaration of a variable, or a result."""
    const = f"const {statement.type} {statement.name} = " if statement.name else ""
    return f"{const}{statement.text};"


def literal(value: Any) -> str:
    """A number in C, to the last bit."""
    if kind_of(value) == "b":
        return str(int(value))
    if not np.isfinite(value):
        return "NAN" if np.isnan(value) else "INFINITY" if value > 0.0 else "-INFINITY"
    # repr gives the shortest text that reads back to the same double.
    text = repr(float(value))
    return f"({text})" if text.startswith("-") else text


def _stored(step: Step) -> set[int]:
    """Numbers of values that are results unchanged, such as values that only change their place."""
    moved: set[int] = set()
    for block in _all_blocks(step.root, step.recording):
        if isinstance(block.result, list):
            moved.update(moving.number for _, moving in block.result if isinstance(moving, Symbol))
    for loop in step.recording.loops.values():
        for end in ends(loop.body):
            if isinstance(end.result, Flat):
                pairs = zip(end.result.numbers, loop.carried, strict=True)
                moved.update(
                    result.number
                    for result, old in pairs
                    if isinstance(result, Symbol) and result is not old
                )
    return moved


def _roots(block: Block, recording: Recording, with_results: bool) -> Iterator[Any]:
    """Guards, conditions, and the results or error texts at the ends of all ways from a block."""
    yield from (symbol for symbol in block.values if symbol.op == "guard")
    if block.condition is not None:
        yield block.condition
        yield from _roots(_of(block.yes), recording, with_results)
        yield from _roots(_of(block.no), recording, with_results)
        return
    result = block.result
    if isinstance(result, Exception):
        yield from values_in_text(result, recording)
    elif not with_results:
        return
    elif isinstance(result, list):
        yield from (number for _, number in result)
    elif isinstance(result, Flat):
        yield from result.numbers
    else:
        yield result


def _used(step: Step) -> set[int]:
    """Numbers of the values that a result depends on."""
    used: set[int] = set()
    due: list[Any] = []

    def note(block: Block, with_results: bool = True):
        due.extend(_roots(block, step.recording, with_results))

    made = _made_by_number(step)
    note(step.root)
    # Go from the roots to all operands.
    while due:
        value = due.pop()
        if not isinstance(value, Symbol) or value.number in used:
            continue
        used.add(value.number)
        due.extend(value.operands)
        # A cached result needs its call.
        if value.op == "kept":
            due.extend(made["call", value.operands[0]])
        elif value.op == "kept_row":
            due.extend(made["call", value.operands[1][0]])
        # A value after a loop needs the loop: start values, condition and body.
        elif value.op in ("after", "loop"):
            due.extend(made["loop", value.operands[0]])
            loop = step.recording.loops[value.operands[0]]
            due.extend(loop.start)
            note(loop.going)
            note(loop.body)
        # A value behind a branch needs the branch, and what its ways set it to.
        elif value.op == "joined":
            number, place = value.operands
            due.extend(made["branch", number])
            for side in step.recording.branches[number].sides:
                due.extend(results_of(side, place))
        elif value.op == "mapped":
            number, place, *_ = value.operands
            due.extend(made["map", number])
            due.extend(results_of(step.recording.maps[number].body, place))
        elif value.op == "map":
            note(step.recording.maps[value.operands[0]].body, with_results=False)
        elif value.op == "branch":
            due.append(step.recording.branches[value.operands[0]].condition)
            for side in step.recording.branches[value.operands[0]].sides:
                note(side, with_results=False)
    return used


def _made_by_number(step: Step) -> dict[tuple, list[Symbol]]:
    """Calls, loops, branches and maps, which are values of their own, by the number that their results name."""
    made: dict[tuple, list[Symbol]] = defaultdict(list)
    for block in _all_blocks(step.root, step.recording):
        for symbol in block.values:
            if symbol.op in ("call", "loop", "branch", "map"):
                made[symbol.op, symbol.operands[0]].append(symbol)
    return made


# The main tree and the trees of all loops and branches.
def _all_blocks(root: Block, recording: Recording):
    roots = [root]
    for loop in recording.loops.values():
        roots += [loop.going, loop.body]
    for branch in recording.branches.values():
        roots += branch.sides
    roots += [mapping.body for mapping in recording.maps.values()]
    while roots:
        block = roots.pop()
        yield block
        if block.condition is not None:
            roots += [_of(block.yes), _of(block.no)]
