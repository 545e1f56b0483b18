"""Start and step of an FMU as recordings, for parameters that only the running FMU knows.

Numbers are symbols. Texts are part of the code; so are flags and counts that shape it. Each set of
them is a variant.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from shipcosim.native.blocks import ends
from shipcosim.native.error_texts import line_of
from shipcosim.native.export.calls import ExportRecording
from shipcosim.native.number_rows import Flat, text_of
from shipcosim.native.recording import Recording
from shipcosim.native.side_effects import only_arithmetic
from shipcosim.native.symbols import Symbol, Untraceable, kind_of
from shipcosim.native.trace import Shape, Step, remember, trace

KINDS = {"Real": "d", "Integer": "i", "Boolean": "b"}
START_TIME, TIME, STEP_SIZE, STATE = range(4)
"""Places in the memory after those of the variables."""


@dataclass(frozen=True, eq=False)
class Variant:
    """An FMU with some values that belong to its code.

    Parameters
    ----------
    fixed : dict of str to text or number
        Those values, by the names of parameters.
    start, step : Step
        Recordings on the memory: the variables in their order, `START_TIME` and so on, then the state.
    places : list of int
        Where the numbers of the step lie in the memory.
    names : list of str
        What they are.
    size : int
        Of the memory.
    """

    fixed: dict[str, Any]
    start: Step
    step: Step
    places: list[int]
    names: list[str]
    size: int


def variant_of(cls: type, values: Mapping[str, Any], step_size: float) -> Variant:
    """Record the variant for some parameters; as few of them as possible are part of the code.

    Parameters
    ----------
    cls : type of Fmu
        The class.
    values : mapping of str to value
        Parameters of an example.
    step_size : float
        Of the example. [s]

    Raises
    ------
    Untraceable
        With what cannot be recorded, and its line.
    """
    parameters = [variable for variable in cls.variables if variable.causality == "parameter"]  # pyright: ignore
    given = {variable.name: values.get(variable.name, variable.start) for variable in parameters}
    # Try the most general code first. Flags and integers become part of it only where the model
    # needs their values. Fixed decisions on parameters are the last resort.
    texts = [variable.name for variable in parameters if variable.type == "String"]
    whole = [variable.name for variable in parameters if variable.type in ("Integer", "Boolean")]
    reasons = []
    for names, decided in (
        (texts, False),
        ([*texts, *whole], False),
        (texts, True),
        ([*texts, *whole], True),
    ):
        try:
            return _recorded(cls, given, names, step_size, decided)
        except Untraceable as reason:
            reasons.append(reason)
    # The last attempt is the least general; its reason is the one that remains.
    raise reasons[-1]


def with_its_line(function: Callable) -> Callable:
    """Raise errors of a function as `Untraceable`, with the line of the component's code."""

    @functools.wraps(function)
    def call(*arguments):
        try:
            return function(*arguments)
        except Untraceable as reason:
            raise Untraceable(f"{line_of(reason)}{reason}") from None
        except Exception as error:  # whatever a model says to a symbol in place of a number
            raise Untraceable(f"{line_of(error)}{type(error).__name__}: {error}") from None

    return call


@with_its_line
def _recorded(cls, given, names, step_size, decided) -> Variant:
    """Record a variant. `decided`: questions on parameters alone are answered as in the example."""
    # Fixed parameters are constants, all other variables are loads from the memory.
    fixed = {name: given[name] for name in names}
    constant = frozenset(fixed)
    unchanging = frozenset(group.name for group in cls.groups)
    n = len(cls.variables)
    example = [0.0 if v.type == "String" else given.get(v.name, v.start) for v in cls.variables]
    settled = (
        {place for place, v in enumerate(cls.variables) if v.causality == "parameter"}
        if decided
        else set()
    )
    recording = ExportRecording([*example, 0.0], settled)
    # Record the start first: it makes the state on which the step works.
    root, clone, flat = _recorded_start(cls, fixed, recording)

    # Every number of the state has a place: that of the FMU's variable of its name, or one of its own behind them.
    references = {variable.name: reference for reference, variable in enumerate(cls.variables)}
    state = iter(range(n + STATE, n + STATE + len(flat.leaves)))
    places = [
        references[leaf.path[0]]
        if len(leaf.path) == 1 and leaf.path[0] in references
        else next(state)
        for leaf in flat.leaves
    ]

    # Choices are numbers by which the code takes one way or another, and which no step changes.
    numbers = _numbers(flat, recording)
    pairs = enumerate(zip(flat.leaves, places, strict=True))
    choices = {
        number for number, (leaf, place) in pairs if leaf.path[0] in unchanging or place in settled
    }
    if decided:
        choices |= _derived(flat, recording)
    shape = Shape(
        _widest(flat, root),
        numbers,
        constant,
        unchanging,
        frozenset(choices) if decided else frozenset(),
    )

    # The step is recorded on the state that the start left.
    step = trace(clone, shape, 0.0, step_size, numbers, ExportRecording)
    _refuse_changing_choices(step, flat)
    # At the end of each way the start writes its state to the same places.
    for end in ends(root):
        if isinstance(end.result, Flat):
            end.result = _written(end.result, flat, places)
    size = max([n + STATE, *(place + 1 for place in places)])
    names = [text_of(leaf.path) for leaf in flat.leaves]
    return Variant(
        fixed,
        Step(recording, root, frozenset()),
        step,
        [*places, n + TIME, n + STEP_SIZE],
        names,
        size,
    )


def _derived(flat: Flat, recording: Recording) -> set[int]:
    """Numbers of the state that the start computes from parameters alone, such as a design."""
    return {
        number
        for number, value in enumerate(flat.numbers)
        if isinstance(value, Symbol) and recording.is_choice(value)
    }


def _refuse_changing_choices(step: Step, flat: Flat) -> None:
    """Refuse code that relies on a number of the state which its own steps change."""
    sources = (source for symbol in step.recording.relied_on for source in symbol.sources())
    relied = {source.operands[0] for source in sources if source.op == "load"}
    for end in ends(step.root):
        for place, _ in end.result if isinstance(end.result, list) else ():
            if place in relied:
                raise Untraceable(
                    f"it decides by {text_of(flat.leaves[place].path)}, which changes"
                )


def _recorded_start(cls, fixed, recording):
    """Record the start: its tree of ways, and instance and flat state of the first complete way."""
    constant = frozenset(fixed)
    unchanging = frozenset(group.name for group in cls.groups)
    made = []

    def run():
        clone = _with_symbols(cls, fixed, recording)
        with only_arithmetic(cls.__module__.partition(".")[0]), _remembering(cls.groups):
            # Derived values of the parameters are computed at the start, so they belong to the
            # memory.
            clone.start()
            for group in cls.groups:
                remember(getattr(clone, group.name))
        # Compiled code has no log, so a message at the start would be lost.
        if clone.messages:
            raise Untraceable("it writes to the log")
        _put_in_order(clone)
        flat = Flat(vars(clone), constant, unchanging)
        made.append((clone, flat))
        # Start and step have one layout, whatever way the start takes.
        if not flat.same_shape(made[0][1]):
            raise Untraceable(
                f"its start gives states of several shapes: {made[0][1].difference(flat)}"
            )
        return flat

    root = recording.record(run)
    # No way reaches the end of the start: report the first error.
    if not made:
        raise next(end.result for end in ends(root))
    return root, *made[0]


def _put_in_order(clone):
    """Sort the attributes, so that their order does not depend on the way of the start."""
    # Declared variables first, all others by name: places are compared by position.
    values = dict(vars(clone))
    first = [*(item.name for item in (*clone.variables, *clone.groups))]
    vars(clone).clear()
    vars(clone).update(
        {name: values[name] for name in [*first, *sorted(values.keys() - set(first))]}
    )


@contextmanager
def _remembering(groups):
    """Let parameter dataclasses compute their cached values when they are made."""
    kinds = [group.kind for group in groups]

    def made(kind, **values):
        parameters = kind(**values)
        remember(parameters)
        return parameters

    for group, kind in zip(groups, kinds, strict=True):
        group.kind = functools.partial(made, kind)
    try:
        yield
    finally:
        for group, kind in zip(groups, kinds, strict=True):
            group.kind = kind


def _with_symbols(cls, fixed, recording: Recording):
    """A component with symbols as inputs and parameters, except the fixed ones."""
    clone = cls("it")
    clone.start_time = recording.value("load", "d", len(cls.variables) + START_TIME)
    values = vars(clone)
    for reference, variable in enumerate(cls.variables):
        if variable.name in fixed:
            values[variable.name] = fixed[variable.name]
        # Outputs are computed by the start, and texts cannot be numbers.
        elif variable.causality != "output" and variable.type != "String":
            values[variable.name] = recording.value("load", KINDS[variable.type], reference)
    return clone


def _numbers(flat, recording):
    """The numbers of an example after its start; zero where they are unknown."""
    numbers = []
    for number in flat.numbers:
        try:
            numbers.append(recording.example(number))
        except (Untraceable, ArithmeticError, ValueError, RecursionError):
            # The value may depend on a loop. Zero is enough: it only answers questions for whole
            # numbers.
            numbers.append(0.0)
    return numbers


def _widest(flat: Flat, root) -> Flat:
    """The leaves of the first way; floats where any way has a float."""
    for end in ends(root):
        if isinstance(end.result, Flat):
            # A number that is a float on one way must not be cut to an integer on another.
            kinds = [kind_of(number) for number in end.result.numbers]
            flat.leaves = [
                leaf._replace(kind="d") if k == "d" else leaf
                for leaf, k in zip(flat.leaves, kinds, strict=True)
            ]
    return flat


def _written(result: Flat, flat: Flat, places) -> list[tuple[int, Any]]:
    """The numbers that a way of the start writes: those that are not in their places already."""
    pairs = zip(places, result.numbers, strict=True)
    return [
        (place, number)
        for place, number in pairs
        if not (isinstance(number, Symbol) and number.op == "load" and number.operands[0] == place)
    ]
