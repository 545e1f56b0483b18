"""Loops of the C text: an operation that is recorded for each element of an array is written once, as a loop."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from shipcosim.native.symbols import Symbol

FEWEST = 4
"""Equal statements above which a loop is shorter than the statements."""


class Term(NamedTuple):
    """What stands in the place of an operand: a variable, an element of an array, a number, or an index alone.

    Parameters
    ----------
    base : str
        Name of the variable or of the array, or the number as C writes it; empty for an index alone.
    index : int, optional
        Of the element, or the index itself.
    is_literal : bool
        Whether it is a number.
    """

    base: str
    index: int | None = None
    is_literal: bool = False

    @property
    def text(self) -> str:
        """The operand in C."""
        return self.base if self.index is None else _element(self.base, str(self.index))


class Statement(NamedTuple):
    """A value and how it is computed, or a result and where it is written.

    Parameters
    ----------
    name : str
        Of the variable that gets the value; empty for a result.
    type : str
        Of that variable.
    template : str
        The C text, with a pair of braces for each operand.
    terms : tuple of Term
        The operands.
    """

    name: str
    type: str
    template: str
    terms: tuple[Term, ...]

    @property
    def text(self) -> str:
        """The right side, or the whole result, in C."""
        return self.template.format(*(term.text for term in self.terms))


def write_in_runs(
    symbols: Sequence[Symbol],
    statement_of: Callable[[Symbol], Statement],
    write: Callable[[list[Statement], list[int]], None],
) -> None:
    """Write assignments; one that goes on with a loop comes before others, where its operands are known.

    Parameters
    ----------
    symbols : sequence of Symbol
        Values, in the order in which they were computed.
    statement_of : callable
        From a value to its statement; it knows the values that are written.
    write : callable
        ``write(run, numbers)`` writes statements of one form, those of the values with these numbers.
    """
    run: list[Statement] = []
    numbers: list[int] = []
    missing = {symbol.number for symbol in symbols}
    similar: dict[tuple, deque[Symbol]] = defaultdict(deque)
    for symbol in symbols:
        similar[symbol.op, symbol.kind].append(symbol)

    def add(symbol, statement):
        run.append(statement)
        numbers.append(symbol.number)
        missing.discard(symbol.number)

    def add_next(symbol):
        """Begin another run where a value does not go on with this one."""
        new = statement_of(symbol)
        fits = not run or goes_on(run, new)
        # Two statements may have the same form by chance: the second can begin a longer run.
        if not fits and len(run) == 2:
            write([run.pop(0)], [numbers.pop(0)])
            fits = goes_on(run, new)
        if not fits:
            write(run, numbers)
            run.clear()
            numbers.clear()
            new = statement_of(symbol)
        add(symbol, new)

    def add_ahead(due):
        """Add the next value of an operation if it goes on with the run; say whether it does."""
        while due and due[0].number not in missing:
            due.popleft()
        # A sum of products: all products first, then the sum.
        if not due or any(
            isinstance(operand, Symbol) and operand.number in missing for operand in due[0].operands
        ):
            return False
        new = statement_of(due[0])
        fits = goes_on(run, new)
        if fits:
            add(due.popleft(), new)
        return fits

    for symbol in symbols:
        if symbol.number in missing:
            add_next(symbol)
            while add_ahead(similar[symbol.op, symbol.kind]):
                pass
    write(run, numbers)


def goes_on(run: Sequence[Statement], new: Statement) -> bool:
    """Whether a statement can be the next turn of the loop that a run of statements makes.

    It must do the same. Each of its operands is the same as in the turns before, or the next element of the same array
    (at an even distance), or another number, or in each turn the value of the turn before.
    """
    first = run[0]
    if (new.template, new.type) != (first.template, first.type):
        return False
    # A sum needs one value to begin with, of the type of its array.
    starts = {
        first.terms[slot] for slot, term in enumerate(new.terms) if term == Term(run[-1].name)
    }
    if len(starts) > 1 or (starts and new.type != "double"):
        return False
    return all(_slot_goes_on(run, slot, term) for slot, term in enumerate(new.terms))


def _slot_goes_on(run, slot, new):
    first = run[0].terms[slot]
    k = len(run)
    if _is_chain(run, slot) or (k == 1 and new == Term(run[0].name)):
        return new == Term(run[-1].name)
    if first.is_literal or new.is_literal or first.index is None or new.index is None:
        return new == first or (first.is_literal and new.is_literal)
    # The distance of two elements follows from the first two turns.
    distance = (run[1].terms[slot].index if k > 1 else new.index) - first.index
    return new == Term(first.base, first.index + k * distance)


def _is_chain(run, slot):
    """Whether an operand is the value of the turn before, as in a sum."""
    return len(run) > 1 and bool(run[0].name) and run[1].terms[slot] == Term(run[0].name)


def loop_of(run: Sequence[Statement]) -> tuple[list[str], list[Term]]:
    """Write a run of statements as a loop.

    Returns
    -------
    lines : list of str
        C text. The array of the values has the name of the first.
    elements : list of Term
        Where each value is found; empty for results.
    """
    first = run[0]
    n = len(run)
    slots = range(len(first.terms))
    chains = [slot for slot in slots if _is_chain(run, slot)]
    # A sum goes from each element of its array to the next; before them stands what it begins with.
    before = 1 if chains else 0
    tables = []
    texts = []
    for slot in slots:
        terms = [statement.terms[slot] for statement in run]
        if slot in chains:
            texts.append(f"{first.name}[i]")
        elif terms[0].index is not None:
            texts.append(_element(terms[0].base, _affine(terms[0].index, terms[1].index)))
        elif len(set(terms)) == 1:
            texts.append(terms[0].text)
        else:
            numbers = ", ".join(term.base for term in terms)
            texts.append(f"n{len(tables)}[i]")
            tables.append(f"static const double n{len(tables)}[] = {{{numbers}}};")
    right = first.template.format(*texts)
    left = f"{first.name}[{_affine(before, before + 1)}] = " if first.name else ""
    loop = f"for (int i = 0; i < {n}; i++) {left}{right};"
    lines = [f"{{ {' '.join(tables)} {loop} }}" if tables else loop]
    if not first.name:
        return lines, []
    if chains:
        lines.insert(0, f"{first.name}[0] = {first.terms[chains[0]].text};")
    lines.insert(0, f"{first.type} {first.name}[{n + before}];")
    return lines, [Term(first.name, before + k) for k in range(n)]


def _element(base: str, index: str) -> str:
    return f"{base}[{index}]" if base else index


def _affine(start: Any, second: Any) -> str:
    """The index of turn i as C text, from the indices of the first two turns."""
    distance = second - start
    if not distance:
        return str(start)
    steps = "i" if distance == 1 else f"{distance} * i"
    return f"{steps} + {start}" if start else steps
