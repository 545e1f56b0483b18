"""C text of a model: its variables, and start and step of each variant."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from shipcosim.native.array_statements import Term
from shipcosim.native.error_texts import parts
from shipcosim.native.export.calls import described, procedure_of
from shipcosim.native.export.variants import Variant
from shipcosim.native.expressions import merged
from shipcosim.native.source import Writer, kept_sizes, literal
from shipcosim.native.symbols import Symbol

LEFT_OUT = 1e30
RECORDER = str(Path(__file__).parents[1])
"""Folder of the code that records a model."""
NOT_FOR_THESE = "this FMU was compiled for another value of "
"""Message of an FMU in C on parameters that would change the shape of its state; their names follow."""
MUCH = 3000
"""Lines of a function above which a compiler takes minutes to make it fast, where it is called seldom."""

_VALUES = re.compile(r"\b(?:[vpc]|start_|step_)[0-9]+\b")
TYPES = {"Real": "REAL", "Integer": "INTEGER", "Boolean": "BOOLEAN", "String": "STRING"}


def source_of_model(cls: Any, identifier: str, variants: Sequence[Variant], words: Callable) -> str:
    """Write the whole C text of an FMU, without its GUID, which depends on it.

    Parameters
    ----------
    cls : type of Fmu
        The class.
    identifier : str
        As in the model description.
    variants : sequence of Variant
        At least one.
    words : callable
        ``words(error)`` is what the FMU in Python says of an error.
    """
    functions = []
    kept = []
    others = {}
    written = set()
    parts_written = []
    for variant in variants:
        # Variants often record the same code, for example where a flag has no effect. Equal ones
        # are written once.
        text, size = _functions(variant, len(parts_written), words, others)
        plain = (*variant.fixed.items(), _plain(text))
        if plain in written:
            continue
        written.add(plain)
        parts_written.append(variant)
        functions.append(text)
        kept.append(size)
    variants = parts_written
    # The runtime checks after each step that all real outputs are finite.
    outputs = [
        str(i) for i, v in enumerate(cls.variables) if v.causality == "output" and v.type == "Real"
    ]
    head = [
        f"#define IDENTIFIER {c_text(identifier)}",
        '#define GUID ""',
        # Sizes for the C runtime: one instance has room for the largest variant.
        f"enum {{ N_VARIABLES = {len(cls.variables)}, N_VARIANTS = {len(variants)}, N_OUTPUTS = {len(outputs)},",
        f"       MOST_MEMORY = {max(variant.size for variant in variants)}, MOST_KEPT = {max(kept)} }};",
        f"#define LEFT_OUT {LEFT_OUT!r}",
        "",
        f"static const int outputs[N_OUTPUTS + 1] = {{{', '.join([*outputs, '0'])}}};",
        "static const Variable variables[N_VARIABLES] = {",
        *(_variable(variable) for variable in cls.variables),
        "};",
        "",
    ]
    # From this table the runtime selects the variant that fits the given parameters.
    table = [
        _variant(cls, number, variant, size)
        for number, (variant, size) in enumerate(zip(variants, kept, strict=True))
    ]
    rows = [*(choices for choices, _ in table), "static const Variant variants[N_VARIANTS] = {"]
    rows += [*(row for _, row in table), "};", ""]
    return "\n".join(
        [
            _runtime("model.h"),
            _runtime("random.h"),
            _runtime("primitives.h"),
            *head,
            *functions,
            *rows,
            _runtime("fmi2.c"),
        ]
    )


def _functions(
    variant: Variant, number: int, words: Callable, others: dict[str, str]
) -> tuple[str, int]:
    """Write start and step of a variant; return the text and the size of their shared cache."""
    n = len(variant.places)
    # Start and step share one array of cached results; those of the step lie behind the start's.
    start = ModelWriter(variant.start, f"start_{number}", words, lambda place: place, 0, others)
    step = ModelWriter(
        variant.step, f"step_{number}", words, variant.places.__getitem__, start.n_kept, others
    )
    # Writing must add no places: the memory is laid out already.
    assert n == len(variant.places)
    return "\n".join([start.function(), step.function()]), start.n_kept + step.n_kept


class ModelWriter(Writer):
    """Writes a recording as a C function for an FMU without Python.

    Parameters
    ----------
    step : Step
        The recording.
    name : str
        Of the function.
    words : callable
        See `source_of_model`.
    place : callable
        Where a number of the recording lies in the memory.
    first_kept : int
        Where the results that it keeps begin.
    others : dict of str to str
        Functions that are written already: names by their texts, and by the calls.
    """

    apart = (*Writer.apart, "primitive")
    results_in = "m"
    """Memory that the results are written to."""

    def __init__(
        self,
        step: Any,
        name: str,
        words: Callable,
        place: Callable[[int], int],
        first_kept: int,
        others: dict[str, str],
    ):
        super().__init__(step)
        self.name = name
        self._words = words
        self._where = place
        self._others = others
        self._names = []
        # The places of arguments and results move behind what others have cached.
        self.n_kept = sum(a + b for a, b in kept_sizes(step.recording))
        self.arguments = [first_kept + first for first in self.arguments]
        self.results = [first_kept + first for first in self.results]

    def function(self) -> str:
        """Write the function and, before it, the functions that it calls."""
        called = []
        for call in self.recording.calls:
            # Start and step make the same calls: each is recorded once.
            made = described(call)
            if made not in self._others:
                procedure = _Procedure(procedure_of(call), self._words, self._others)
                self._others[made], text = procedure.named_function()
                called.append(text)
            self._names.append(self._others[made])
        self._block(self.step.root, 1, self._finish)
        # Without optimisation very long functions compile in seconds; they run seldom.
        much = "PLAIN " if len(self.lines) > MUCH else ""
        head = f"static {much}int {self.name}(double *restrict m, double *restrict k, Instance *o)"
        return "\n".join(
            [
                *called,
                head,
                "{",
                *self._tables("    "),
                "    (void)m, (void)k, (void)o;",
                *merged(self.lines),
                "}",
                "",
            ]
        )

    def _place(self, place):
        return self._where(place)

    def _finish(self, result, depth):
        if isinstance(result, list):
            places = ((self._place(place), number) for place, number in result)
            self._write(self.results_in, places, depth)
            self._put(depth, "return DONE;")
        else:
            self._put(depth, self._fail(result))

    def _fail(self, error):
        _forget_recorder(error)
        return f"{{ {self._say(self._words(error))}return GIVEN_UP; }}"

    def _say(self, text: str) -> str:
        """Write C statements that report a text with its values."""
        statements = []
        for words, how in parts(text):
            if not how:
                statements.append(f"say(o, {c_text(words)});")
                continue
            symbol = self.recording.named[int(words)]
            value = self.operand(symbol)
            # A value with a format goes to printf; integers are doubles in C, so `d` becomes `.0f`.
            if how != "r":
                statements.append(
                    f"say_number(o, {value}, {c_text('%' + how.replace('d', '.0f'))});"
                )
            elif symbol.kind == "i":
                statements.append(f'say_number(o, {value}, "%.0f");')
            else:
                statements.append(
                    f"{'say_truth' if symbol.kind == 'b' else 'say_float'}(o, {value});"
                )
        return "".join(f"{statement} " for statement in statements)

    def _other(self, symbol, expected):
        # The variables lie first in the memory; what lies behind them is the state.
        said = [
            f'say(o, {place} < N_VARIABLES ? variables[{place}].name : "a number of its state");'
            for place in self._loaded(symbol)
        ]
        names = ' say(o, " and "); '.join(said) or 'say(o, "a number");'
        message = (
            f"say(o, {c_text(NOT_FOR_THESE)}); {names}"
            ' say(o, ": take the FMU in Python, or build this one again"); o->is_for_others = 1;'
        )
        return f"{{ {message} return GIVEN_UP; }}"

    def _loaded(self, symbol: Symbol) -> list[int]:
        """Places in the memory on which a value depends."""
        waiting = [symbol]
        seen = {symbol.number}
        places = set()
        while waiting:
            value = waiting.pop()
            if value.op == "load":
                places.add(self._place(value.operands[0]))
            for operand in value.operands:
                if isinstance(operand, Symbol) and operand.number not in seen:
                    seen.add(operand.number)
                    waiting.append(operand)
        return sorted(places)

    def _value(self, symbol: Symbol, depth):
        if symbol.op != "primitive":
            super()._value(symbol, depth)
            return
        name, size, *arguments = symbol.operands
        # C cannot return an array: the primitive writes its result to a local one.
        self._put(depth, f"double p{symbol.number}[{size}];")
        self._put(depth, f"{{ double a[{len(arguments)}];")
        self._write("a", enumerate(arguments), depth + 1)
        self._put(depth + 1, f"{name}(p{symbol.number}, a, {len(arguments)}); }}")

    def _place_of(self, symbol):
        if symbol.op == "part":
            primitive, place = symbol.operands
            return Term(f"p{primitive.number}", place)
        return super()._place_of(symbol)

    def _put_call(self, number, where, again, depth):
        self._put(depth, f"if ({self._names[number]}({where}, o)) {{")
        self._put(depth + 1, f"{again}return GIVEN_UP;")
        self._put(depth, "}")


class _Procedure(ModelWriter):
    """Writes a function with cached results: arguments in `m`, results in `k`."""

    results_in = "k"

    def _loaded(self, symbol: Symbol) -> list[int]:
        return []  # its memory holds arguments, which have no names

    def __init__(self, procedure: Any, words: Callable, others: dict[str, str]):
        super().__init__(procedure, "kept", words, lambda place: place, 0, others)

    def named_function(self) -> tuple[str, str]:
        """Its name and text; the text is empty if an equal function exists."""
        text = self.function()
        # Components with the same tables call equal functions; one copy in C serves all.
        plain = _plain(text)
        if plain in self._others:
            return self._others[plain], ""
        name = self._others[plain] = f"kept_{len(self._others)}"
        return name, text.replace(f"int {self.name}(", f"int {name}(", 1)


def _plain(text: str) -> str:
    """Rename the variables of a text in order: equal for functions that compute the same."""
    numbers = {
        number: f"v{place}" for place, number in enumerate(dict.fromkeys(_VALUES.findall(text)))
    }
    return _VALUES.sub(lambda match: numbers[match[0]], text)


def _forget_recorder(error: Exception):
    """Take the frames of the recorder out of a traceback: they lie on the machine that builds the FMU."""
    trace = error.__traceback__
    while trace:
        if trace.tb_next and trace.tb_next.tb_frame.f_code.co_filename.startswith(RECORDER):
            trace.tb_next = trace.tb_next.tb_next
        else:
            trace = trace.tb_next


def _variable(variable) -> str:
    # A missing bound is infinite, so that the runtime needs no special case.
    text = variable.type == "String"
    parts = [
        c_text(variable.name),
        TYPES[variable.type],
        variable.causality.upper(),
        str(int(variable.tunable)),
        str(int(variable.required)),
        *(literal(number) for number in (*variable.bounds, 0.0 if text else variable.start)),
        c_text(variable.unit),
        c_text(variable.start) if text else '""',
    ]
    return f"    {{{', '.join(parts)}}},"


def _variant(cls, number, variant: Variant, kept: int) -> tuple[str, str]:
    # A variant is chosen by its fixed values: reference, number and text of each.
    references = {variable.name: reference for reference, variable in enumerate(cls.variables)}
    choices = [
        f"{{{references[name]}, {'0.0' if isinstance(value, str) else literal(value)}, "
        f"{c_text(value) if isinstance(value, str) else 'NULL'}}}"
        for name, value in variant.fixed.items()
    ]
    table = (
        f"static const Choice choices_{number}[] = {{{', '.join([*choices, '{0, 0.0, NULL}'])}}};"
    )
    row = f"{len(choices)}, {variant.size}, {kept}, choices_{number}, start_{number}, step_{number}"
    return table, f"    {{{row}}},"


def c_text(value: str) -> str:
    """A text as a C literal, split into parts that every compiler accepts."""
    escapes = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r", "?": "\\?"}
    # Non-ASCII letters are written as octal bytes of UTF-8; `?` is escaped against trigraphs.
    letters = [
        escapes.get(c, c if " " <= c <= "~" else "".join(f"\\{b:03o}" for b in c.encode()))
        for c in value
    ]
    return (
        " ".join('"' + "".join(letters[i : i + 500]) + '"' for i in range(0, len(letters), 500))
        or '""'
    )


def _runtime(name: str) -> str:
    return files("shipcosim.native").joinpath("runtime", name).read_text(encoding="utf-8")
