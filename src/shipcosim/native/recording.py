"""A step of a component, recorded: its blocks of values, and the parts that C has as one statement with a body."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from shipcosim.native.blocks import (
    Block,
    BlockTree,
    RecordedBranch,
    RecordedLoop,
    RecordedMap,
    ends,
    results_of,
)
from shipcosim.native.number_rows import Flat, made_like
from shipcosim.native.symbols import Maths, Symbol, Untraceable, kind_of


class Recording(BlockTree):
    """A tree of blocks with loops, choices, maps over rows and rows of tables."""

    def repeat(self, going: Callable[[Any], Any], turn: Callable[[Any], Any], state: Any) -> Any:
        """Record a loop; return the state after it."""
        numbers = self._once(lambda: self._recorded_loop(going, turn, state))
        return made_like(state, iter(numbers))

    def _recorded_loop(self, going, turn, state) -> list[Symbol]:
        # The state is carried: at each turn the body sees new symbols in place of its numbers.
        flat = Flat(state)
        parent = self.block
        kinds = [leaf.kind for leaf in flat.leaves]
        # Repeat the recording until the kinds of the state stay the same. A number may start as an
        # integer and become a float in the body.
        while True:
            number = self._new_number()
            self._starts[number] = flat.numbers
            carried = [
                self.fresh("carried", kind, number, place) for place, kind in enumerate(kinds)
            ]
            state_then = made_like(state, iter(carried))
            # Condition and body are recorded apart: C tests the condition before each turn.
            condition = self.record(lambda state=state_then: going(state), parent)
            body = self.record(lambda state=state_then: Flat(turn(state)), parent)
            # C has fixed variables, so the state must keep its shape.
            for end in ends(body):
                if isinstance(end.result, Flat) and not end.result.same_shape(flat):
                    raise Untraceable(
                        f"in a loop the state changes its shape: {flat.difference(end.result)}"
                    )
            # A value is a float if any way through the body makes it one.
            after = [end.result.leaves for end in ends(body) if isinstance(end.result, Flat)]
            wider = [
                "d" if any(way[i].kind == "d" for way in after) else kind
                for i, kind in enumerate(kinds)
            ]
            if wider == kinds:
                break
            kinds = wider
        # The loop itself is a value, so that it is computed in its place among the others.
        self.loops[number] = RecordedLoop(flat.numbers, carried, condition, body)
        self.fresh("loop", "d", number)
        return [self.fresh("after", kind, number, place) for place, kind in enumerate(kinds)]

    def choose(
        self, condition: Symbol, then: Callable[[], Any], otherwise: Callable[[], Any]
    ) -> Any:
        """Record both of two functions; return the result of the one that the condition chooses."""
        # What is known on this way, or fixed in the code, needs no branch.
        if condition.number in self._answers or self.is_choice(condition):
            return then() if self.decide(condition) else otherwise()
        value, numbers = self._once(lambda: self._recorded_branch(condition, then, otherwise))
        return made_like(value, iter(numbers))

    def _recorded_branch(self, condition, then, otherwise) -> tuple[Any, list]:
        # Inside, the same question has this answer.
        outer = self._answers
        self._answers = outer | {condition.number: True}
        yes, of_yes = self._part(then)
        self._answers = outer | {condition.number: False}
        no, of_no = self._part(otherwise)
        self._answers = outer
        value, flat = _of_one_shape([*of_yes, *of_no])
        # The branch itself is a value, so that it is computed in its place among the others.
        number = self._new_number()
        self.branches[number] = RecordedBranch(condition, yes, no)
        self.fresh("branch", "d", number)
        return value, [self._joined(number, place) for place in range(len(flat.leaves))]

    def _joined(self, number: int, place: int) -> Any:
        """A number behind a branch: the same on all ways, or one that each way has set."""
        results = [
            result for side in self.branches[number].sides for result in results_of(side, place)
        ]
        first = results[0]
        if isinstance(first, Symbol):
            is_common = first.block in self.block.lineage and all(
                result is first for result in results
            )
        else:
            # As texts: 0.0 and -0.0 are equal numbers.
            is_common = {(type(result), repr(result)) for result in results} == {
                (type(first), repr(first))
            }
        if is_common:
            return first
        return self.fresh("joined", _common_kind(results), number, place)

    def mapped(self, function: Callable, columns: Sequence[Any]) -> list[Any]:
        """Record a function of one number of each column; return its results for all rows."""
        value, rows = self._once(lambda: self._recorded_map(function, columns))
        return [made_like(value, iter(row)) for row in rows]

    def _recorded_map(self, function, columns) -> tuple[Any, list]:
        # The columns become arrays before the loop, which reads them by its index.
        for column in columns:
            self._stored(Flat(column).numbers)
        number = self._new_number()
        index = self.fresh("index", "i", number)
        body, made = self._part(
            lambda: function(*(self.row_of(column, index) for column in columns))
        )
        value, flat = _of_one_shape(made)
        self.maps[number] = RecordedMap(len(columns[0]), body)
        # The loop itself is a value, so that it is computed in its place among the others.
        self.fresh("map", "d", number)
        places = range(len(flat.leaves))
        kinds = [_common_kind(results_of(body, place)) for place in places]
        return value, [
            [self.fresh("mapped", kinds[k], number, k, row) for k in places]
            for row in range(len(columns[0]))
        ]

    def _part(self, function: Callable[[], Any]) -> tuple[Block, list[tuple[Any, Flat]]]:
        """Record a part of a step; return it and its results, one for each way without an error."""
        made = []

        def run():
            value = function()
            made.append((value, Flat(value)))
            return made[-1][1]

        return self.record(run, self.block), made

    def row_of(self, table: Any, index: Symbol) -> Any:
        """The row of a table, or element of a sequence, at a symbolic index."""
        if isinstance(table, np.ndarray):
            shape = table.shape[1:]
            elements = self._read(table.ravel(), index, math.prod(shape))
            return np.array(elements, dtype=object).reshape(shape) if shape else elements[0]
        row, flat = _of_one_shape([(row, Flat(row)) for row in table])
        # Negative indices count from the end of a sequence, as in Python.
        index = Maths.where(index < 0, index + len(table), index)
        return made_like(row, iter(self._read(Flat(table).numbers, index, len(flat.leaves))))

    def _read(self, numbers: Sequence[Any] | np.ndarray, index: Symbol, width: int) -> list[Symbol]:
        """The numbers of the row at an index, of rows that lie one behind the other."""
        op, base = self._stored(numbers)
        # Constant tables and arrays hold floats.
        if isinstance(numbers, np.ndarray):
            kinds = ["d"] * width
        else:
            kinds = [_common_kind(numbers[column::width]) for column in range(width)]
        return [
            self.value(op, kind, index, base, width, column) for column, kind in enumerate(kinds)
        ]

    def _stored(self, numbers: Sequence[Any] | np.ndarray) -> tuple[str, Any]:
        """Where numbers lie in sequence: the operation that reads one by an index, and its operand."""
        is_constant = isinstance(numbers, np.ndarray) and numbers.dtype != object
        if is_constant or not any(isinstance(number, Symbol) for number in numbers):
            return "row", self.table(np.asarray(numbers, dtype=float))
        first = numbers[0]
        if isinstance(first, Symbol) and first.op in ("load", "kept"):
            *before, place = first.operands
            in_sequence = (
                isinstance(number, Symbol)
                and (number.op, number.operands) == (first.op, (*before, place + k))
                for k, number in enumerate(numbers)
            )
            if all(in_sequence):
                return f"{first.op}_row", first.operands
        # All others are copied to an array.
        return "array_row", self.value("array", "d", *numbers)


def _of_one_shape(made: Sequence[tuple[Any, Flat]]) -> tuple[Any, Flat]:
    """The first of some values that are taken apart; C has fixed variables, so all have its shape."""
    if not made:
        raise Untraceable("a part of it ends with an error on all ways")
    _, first = made[0]
    for _, other in made[1:]:
        if not other.same_shape(first):
            raise Untraceable(f"its values have two shapes: {first.difference(other)}")
    return made[0]


def _common_kind(numbers: Iterable[Any]) -> str:
    """Kind of a variable that may have any of some numbers."""
    kinds = {kind_of(number) for number in numbers}
    return kinds.pop() if len(kinds) == 1 else "d"
