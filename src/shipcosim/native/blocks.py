"""A function recorded as a tree of blocks of values: one pass for each way through it."""

from __future__ import annotations

import itertools
import math
import operator
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from shipcosim.native.number_rows import Flat, made_like
from shipcosim.native.side_effects import anything
from shipcosim.native.symbols import Maths, Symbol, Untraceable

MOST_PATHS = 200
"""Ways through one step beyond which a component is no longer recorded."""


MOST_VALUES = 150_000
"""Values in one step beyond which a component is no longer recorded: the compiler would take minutes."""


class Call(NamedTuple):
    """A function whose result is cached while its arguments stay equal.

    Parameters
    ----------
    function : callable
        Called in Python.
    arguments : tuple
        Of the example.
    changing : list of int
        Which of the numbers in the arguments change; the others are always those of the example.
    result : any
        Of the example.
    """

    function: Callable
    arguments: tuple
    changing: list[int]
    result: Any


@dataclass(eq=False)
class Block:
    """Values computed in sequence, and what follows: two blocks or the end.

    Attributes
    ----------
    number : int
        Of the block.
    lineage : frozenset of int
        Numbers of the blocks whose values are known in this one.
    values : list of Symbol
        In the order in which they are computed.
    known : dict
        The same by operation and operands: what is computed twice is one value.
    parts : list
        What loops and branches in it gave, in their order: another pass over this block finds them again.
    condition : Symbol or None
        Decides between `yes` and `no`.
    result : Any
        What the model gave at the end of this way; None where the block forks.
    """

    number: int = field(default_factory=itertools.count().__next__)
    values: list[Symbol] = field(default_factory=list)
    known: dict = field(default_factory=dict)
    parts: list = field(default_factory=list)
    parent: Block | None = None
    condition: Symbol | None = None
    yes: Block | None = None
    no: Block | None = None
    result: Any = None

    def __post_init__(self):
        before = frozenset() if self.parent is None else self.parent.lineage
        self.lineage: frozenset[int] = before | {self.number}


@dataclass(eq=False)
class RecordedLoop:
    """A body that is repeated while a condition holds.

    Attributes
    ----------
    start : list
        Numbers and symbols that the carried values begin with.
    carried : list of Symbol
        The values as the body and the condition see them.
    going, body : Block
        What computes the condition, and the values after one more turn: lists, at the ends of their ways.
    """

    start: list
    carried: list[Symbol]
    going: Block
    body: Block


@dataclass(eq=False)
class RecordedBranch:
    """Two bodies of which a condition chooses one; the values after them are joined.

    Attributes
    ----------
    condition : Symbol
        Chooses `yes` or `no`.
    yes, no : Block
        What computes the results: lists, at the ends of their ways.
    """

    condition: Symbol
    yes: Block
    no: Block

    @property
    def sides(self) -> tuple[Block, Block]:
        """Both bodies."""
        return self.yes, self.no


@dataclass(eq=False)
class RecordedMap:
    """A body that is computed once for each row of some arrays.

    Attributes
    ----------
    count : int
        Number of rows.
    body : Block
        What computes the results of a row: lists, at the ends of its ways.
    """

    count: int
    body: Block


class BlockTree:
    """All values that a function computes, as a tree of blocks.

    Parameters
    ----------
    example : (n,) sequence of float
        Memory, time and step size of an example, which decides where a model asks for a whole number.
    choices : set of int
        Places in the memory of whole numbers that decide as in the example what follows from them alone.

    Attributes
    ----------
    root : Block
        Where every way begins.
    tables : list of (n,) array
        Constant numbers that are looked up by an index.
    calls : list of Call
        Functions that stay in Python.
    loops : dict of int to RecordedLoop
        Recorded loops.
    branches : dict of int to RecordedBranch
        Recorded choices whose two ways come together again.
    maps : dict of int to RecordedMap
        Recorded loops over rows.
    relied_on : list of Symbol
        Values that must be what they are in the example.
    named : dict of int to Symbol
        Values that were put into texts, by their numbers.
    """

    stands_alone = False
    """Whether the code is for other parameters too, without Python, and has a C runtime for products of matrices."""

    most_ways = MOST_PATHS

    def __init__(self, example: Sequence[float], choices: Set[int] = frozenset()):
        self.memory = example
        self._choices = choices
        self._arguments: dict[int, tuple[Symbol, ...]] = {}
        self.tables: list[np.ndarray] = []
        self.calls: list[Call] = []
        self.loops: dict[int, RecordedLoop] = {}
        self.branches: dict[int, RecordedBranch] = {}
        self.maps: dict[int, RecordedMap] = {}
        self._new_number = itertools.count().__next__
        self.relied_on: list[Symbol] = []
        self.count = 0
        self.named: dict[int, Symbol] = {}
        self._table_numbers: dict = {}
        self._call_numbers: dict = {}
        self._asked: Counter[str] = Counter()
        self._starts: dict[int, list] = {}
        self._examples: dict[int, Any] = {}
        self.root = self.block = Block()
        self._answers: dict[int, bool] = {}
        self._prefix: tuple[bool, ...] = ()
        self._taken: list[bool] = []
        self._due: list[tuple[bool, ...]] = []
        self._passed: Counter[int] = Counter()

    def record(self, function: Callable[[], Any], parent: Block | None = None) -> Block:
        """Run a function once for each way through it; each way ends with its result.

        A way on which the function raises an error ends with the error as its result.

        Raises
        ------
        Untraceable
        """
        # Recordings nest (a loop's body has its own ways), so keep the state of the outer one.
        before = self.block, self._answers, self._prefix, self._taken, self._due, self._passed
        root = Block(parent=parent)
        self._due = [()]
        ways = 0
        # Each pass follows a prefix of answers, then answers yes. `decide` notes the other answers
        # for later passes; the shortest come first, so that too many ways are seen early.
        while self._due:
            self._prefix = self._due.pop(0)
            self._taken = []
            self._passed = before[-1].copy()
            self.block = root
            # Answers of the outer way also hold inside.
            self._answers = dict(before[1])
            ways += 1
            # Each way that is due is one more: stop as soon as they are too many.
            if ways + len(self._due) > self.most_ways:
                # The line that asks most tells the author what to change.
                (where, _), *_ = self._asked.most_common(1)
                raise Untraceable(
                    f"it has more than {self.most_ways} ways through a step, most of them by {where}"
                )
            try:
                result = function()
            except (Untraceable, AssertionError, MemoryError, RecursionError):
                raise
            # Errors that a model raises on purpose are the result of this way. Others are faults of
            # the recording and go up.
            except Exception as error:
                if (
                    not isinstance(error, (ArithmeticError, ValueError))
                    and type(error).__name__ != "FmuError"
                ):
                    raise
                result = error
            # A value of another way or loop would not exist here in C.
            if isinstance(result, Flat):
                for number in result.numbers:
                    self.refuse_left_behind(number)
            self.block.result = result
        self.block, self._answers, self._prefix, self._taken, self._due, self._passed = before
        return root

    def _once(self, record: Callable[[], Any]) -> Any:
        """What a part of this block gave in an earlier pass over it, or gives now."""
        block = self.block
        place = self._passed[block.number]
        self._passed[block.number] += 1
        if place == len(block.parts):
            block.parts.append(record())
        return block.parts[place]

    def decide(self, condition: Symbol) -> bool:
        """Answer a question of Python's on this way."""
        # The same question has the same answer on one way.
        if condition.number in self._answers:
            return self._answers[condition.number]
        # A question on fixed whole numbers alone does not fork: the code is for this answer.
        if self.is_choice(condition):
            return bool(self.guarded(condition))
        # Count the asking line, to name it if there are too many ways.
        frame = sys._getframe(2)
        file = frame.f_code.co_filename.replace("\\", "/").rpartition("/")[2]
        self._asked[f"line {frame.f_lineno} of {file}"] += 1
        # Follow the prefix; beyond it, answer yes and note the way with the answer no.
        number = len(self._taken)
        answer = self._prefix[number] if number < len(self._prefix) else True
        if number >= len(self._prefix):
            self._due.append((*self._taken, False))
        self._taken.append(answer)
        self._answers[condition.number] = answer
        block = self.block
        # The first pass forks the block; later passes take its other branch.
        if block.condition is None:
            block.condition, block.yes, block.no = (
                condition,
                Block(parent=block),
                Block(parent=block),
            )
        following = block.yes if answer else block.no
        assert block.condition is condition and following is not None
        self.block = following
        return answer

    def is_choice(self, condition: Symbol) -> bool:
        """True if a condition depends only on whole numbers that are part of the code."""
        for source in condition.sources():
            if source.op == "load":
                if source.operands[0] not in self._choices:
                    return False
            # A kept result follows from the arguments of its call.
            elif source.op == "kept":
                if not all(map(self.is_choice, self._arguments[source.operands[0]])):
                    return False
            elif source.op not in EXAMPLES:
                return False
        return True

    def value(self, op: str, kind: str, *operands: Any) -> Symbol:
        """The value of an operation; one already computed on this way is used again."""
        # Symbols are equal by identity. Numbers are compared with their type: 1 is not 1.0 in C.
        key = op, *(id(o) if isinstance(o, Symbol) else (type(o), repr(o)) for o in operands)
        # Values of the blocks before this one are known here: search up to the root.
        block: Block | None = self.block
        while block is not None:
            if key in block.known:
                return block.known[key]
            block = block.parent
        self.block.known[key] = symbol = self.fresh(op, kind, *operands)
        return symbol

    def fresh(self, op: str, kind: str, *operands: Any) -> Symbol:
        """Add a new value to the current block."""
        if self.count >= MOST_VALUES:
            raise Untraceable(f"it computes more than {MOST_VALUES} values in a step")
        for operand in operands:
            self.refuse_left_behind(operand)
        symbol = Symbol(self, self.count, op, kind, operands, self.block.number)
        self.count += 1
        self.block.values.append(symbol)
        return symbol

    def kept(self, function: Callable, arguments: tuple) -> Any:
        """The result of a function that is called again only when its arguments change."""
        given = Flat(arguments)
        # Equal calls in a step share one place for their result.
        key = (
            function,
            *(
                id(argument) if isinstance(argument, Symbol) else argument
                for argument in given.numbers
            ),
        )
        if key not in self._call_numbers:
            # Call it once with the example: the result tells its shape.
            numbers = (
                typed(self.example(argument), leaf.kind)
                for argument, leaf in zip(given.numbers, given.leaves, strict=True)
            )
            example = made_like(arguments, numbers)
            self._call_numbers[key] = len(self.calls)
            changing = [
                place
                for place, argument in enumerate(given.numbers)
                if isinstance(argument, Symbol)
            ]
            # It may do what a step must not: it runs in Python, not in C.
            with anything(), np.errstate(all="ignore"):
                self.calls.append(Call(function, example, changing, function(*example)))
        number = self._call_numbers[key]
        # The call is a value, so C makes it before its results are used.
        result = self.calls[number].result
        symbols = tuple(argument for argument in given.numbers if isinstance(argument, Symbol))
        self._arguments[number] = symbols
        self.value("call", "d", number, *symbols)
        flat = Flat(result)
        kept = [
            self.value("kept", leaf.kind, number, place) for place, leaf in enumerate(flat.leaves)
        ]
        return marked(made_like(result, iter(kept)))

    def refuse_left_behind(self, value: Any) -> None:
        """Raise Untraceable for a value of another way or loop that Python has kept."""
        if isinstance(value, Symbol) and value.block not in self.block.lineage:
            raise Untraceable(
                "it keeps a value of a loop or of another way in a variable of its own"
            )

    def guarded(self, symbol: Symbol) -> int:
        """The value in the example, as a constant of the code; C gives up where it differs."""
        # A loop changes its values at each turn; no single number can be guarded.
        if any(source.op in OF_LOOPS for source in symbol.sources()):
            raise Untraceable("it asks for a whole number that follows from a loop or a choice")
        expected = int(self.example(symbol))
        # C tests the guard at run time, and the record notes on which numbers it relies.
        self.value("guard", "d", symbol, expected)
        self.relied_on.append(symbol)
        return expected

    def table(self, numbers: np.ndarray) -> int:
        """Number of a constant table; equal tables share one number."""
        numbers = np.ascontiguousarray(numbers, dtype=float).ravel()
        number = self._table_numbers.setdefault(numbers.tobytes(), len(self.tables))
        if number == len(self.tables):
            self.tables.append(numbers)
        return number

    def example(self, value: Any) -> Any:
        """Value of a symbol in the example.

        Raises
        ------
        Untraceable
            It depends on what a loop has computed.
        """
        if not isinstance(value, Symbol):
            return value
        if value.number not in self._examples:
            self._examples[value.number] = self._computed(value)
        return self._examples[value.number]

    def _computed(self, value):
        # Evaluate by operation. Operands are evaluated the same way, each only once.
        op = value.op
        operands = value.operands
        if op == "load":
            return typed(self.memory[operands[0]], value.kind)
        if op == "kept":
            return Flat(self.calls[operands[0]].result).numbers[operands[1]]
        if op in ("carried", "after"):  # as at the start of the loop
            return self.example(self._starts[operands[0]][operands[1]])
        if op == "joined":
            branch = self.branches[operands[0]]
            end = branch.yes if self.example(branch.condition) else branch.no
            while end.condition is not None:
                following = end.yes if self.example(end.condition) else end.no
                assert following is not None
                end = following
            if not isinstance(end.result, Flat):
                raise Untraceable("a choice ends with an error in the example")
            return self.example(end.result.numbers[operands[1]])
        if op == "row":
            index, table, width, column = operands
            # A row of a table: elements lie row by row.
            return float(self.tables[table][self.example(index) * width + column])
        if op == "array_row":
            index, array, width, column = operands
            return self.example(array.operands[int(self.example(index)) * width + column])
        if op == "load_row":
            index, (place,), width, column = operands
            return float(self.memory[place + self.example(index) * width + column])
        if op == "interp":
            x, first, second, _ = operands
            return float(np.interp(self.example(x), self.tables[first], self.tables[second]))
        if op not in EXAMPLES:
            raise Untraceable(f"it asks for a whole number that follows from '{op}'")
        return EXAMPLES[op](*(self.example(operand) for operand in operands))


OF_LOOPS = ("carried", "after", "joined", "index", "mapped")
"""Operations whose values follow from a loop or a choice."""


def results_of(root: Block, place: int) -> list[Any]:
    """The numbers at a place of the results, one for each way without an error."""
    return [end.result.numbers[place] for end in ends(root) if isinstance(end.result, Flat)]


def ends(block: Block) -> Iterator[Block]:
    """The ends of all ways from a block."""
    if block.condition is None:
        yield block
    else:
        for following in (block.yes, block.no):
            assert following is not None
            yield from ends(following)


def typed(number: Any, kind: str) -> float | int | bool:
    """A number with the Python type of a symbol's kind."""
    return float(number) if kind == "d" else bool(number) if kind == "b" else int(number)


def marked(value: Any) -> Any:
    """Mark an object that holds symbols, so that caches by identity treat it as symbolic."""
    for part in value if isinstance(value, tuple) else (value,):
        if hasattr(part, "__dict__"):
            part.__dict__["maths"] = Maths
    return value


_OF_MATH = (
    "floor ceil sin cos tan exp log log1p sqrt tanh asin acos atan sinh cosh log10 atan2 copysign"
)
EXAMPLES: dict[str, Callable] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "**": operator.pow,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "&": operator.and_,
    "|": operator.or_,
    "^": operator.xor,
    "neg": operator.neg,
    "not": operator.not_,
    "abs": abs,
    "round": round,
    "number": float,
    "whole": int,
    "where": lambda condition, a, b: a if condition else b,
}
EXAMPLES |= {name: getattr(math, name) for name in _OF_MATH.split()}
"""Operations in Python."""
