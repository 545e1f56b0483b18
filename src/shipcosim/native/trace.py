"""Record one step of a component: the numbers of its state, and their new values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

from shipcosim.native.blocks import Block, ends
from shipcosim.native.number_rows import Flat, attributes_like, numbers_of, text_of
from shipcosim.native.recording import Recording
from shipcosim.native.side_effects import only_arithmetic
from shipcosim.native.symbols import Symbol, Untraceable, kind_of

STANDS = (
    "messages",
    "_in_binary",
    "_initialised",
    "_initialising",
    "_stale",
    "_time",
    "instance_name",
    "start_time",
)


@dataclass(frozen=True, eq=False)
class Shape:
    """Numbers and structure of a component.

    Parameters
    ----------
    flat : Flat
        Its attributes, taken apart; those of the first instance of this shape.
    numbers : list
        Its numbers.
    constant, unchanging : frozenset of str
        Attributes that are part of the structure; dataclasses of parameters, whose flags are.
    choices : frozenset of int
        Places of whole numbers among the parameters: where a step asks for one, it belongs to what it is then.
    """

    flat: Flat
    numbers: list
    constant: frozenset[str]
    unchanging: frozenset[str]
    choices: frozenset[int]


@dataclass(frozen=True, eq=False)
class Step:
    """Effect of one step on the memory: numbers, time at the start of the step, step size.

    Parameters
    ----------
    recording : Recording
        The values.
    root : Block
        Where they begin; each way ends with the (place, value) pairs that change, or an error.
    outputs : frozenset of int
        Places of the real outputs, which must be finite.
    """

    recording: Recording
    root: Block
    outputs: frozenset[int]


def shape_of(fmu: Any) -> Shape:
    """Separate numbers and structure of a component after its start.

    Raises
    ------
    Untraceable
        It keeps what is no plain data.
    """
    # Compute cached values of the parameters now, so that they are part of the memory.
    whole, constant, unchanging = _structure_of(type(fmu))
    for group in fmu.groups:
        remember(getattr(fmu, group.name))
    # The fast comparison of structure finds a shape seen before; only a new one is taken apart.
    numbers, rest = numbers_of(vars(fmu), constant, unchanging)
    # by name, which is that of a content: each run has a class of its own
    key = type(fmu).__module__, type(fmu).__qualname__, whole, constant, unchanging, rest
    shape = _SHAPES.get(key)
    if shape is None:
        flat = Flat(vars(fmu), constant, unchanging)
        # Whole numbers of the parameters may decide in the code; all other numbers may change.
        choices = (
            n
            for n, leaf in enumerate(flat.leaves)
            if leaf.kind == "i" and leaf.path[0] in whole | unchanging
        )
        shape = Shape(flat, numbers, constant, unchanging, frozenset(choices))
        if len(_SHAPES) >= MOST_SHAPES:
            _SHAPES.clear()
        _SHAPES[key] = shape
    return replace(shape, numbers=numbers)


_SHAPES: dict[tuple, Shape] = {}
MOST_SHAPES = 200
"""Shapes that are remembered: components in a process, as a rule."""


@lru_cache(maxsize=200)
def _structure_of(cls):
    """Names of the integer parameters, the structural variables and the parameter groups."""
    parameters = [variable for variable in cls.variables if variable.causality == "parameter"]
    # Texts and flags are structure. Integers are numbers that may become part of the code.
    whole = frozenset(variable.name for variable in parameters if variable.type == "Integer")
    constant = frozenset(variable.name for variable in cls.variables if variable.type == "String")
    constant |= {variable.name for variable in parameters if variable.type == "Boolean"}
    return whole, constant, frozenset(group.name for group in cls.groups)


def trace(
    fmu: Any,
    shape: Shape,
    time: float,
    step_size: float,
    numbers: Sequence[float] | None = None,
    kind: type[Recording] = Recording,
) -> Step:
    """Record one step of a component.

    Parameters
    ----------
    fmu : Fmu
        An instance after its start; it stays as it is.
    shape : Shape
        Its numbers and its structure.
    time, step_size : float
        Of the example step. [s, s]
    numbers : sequence of float, optional
        Those of the example; of the component where they are left out.
    kind : type of Recording
        What the values are recorded in.

    Raises
    ------
    Untraceable
        With what in the component cannot be recorded.
    """
    before = shape.flat
    constant = shape.constant
    unchanging = shape.unchanging
    values = dict(vars(fmu))
    n = len(before.leaves)
    recording = kind(
        [*(shape.numbers if numbers is None else numbers), time, step_size], shape.choices
    )

    def run():
        # Each way starts from the memory: every number of the state is a load.
        loads = [
            recording.value("load", leaf.kind, place) for place, leaf in enumerate(before.leaves)
        ]
        # A clone without its start: its state is the memory's. The original stays unchanged.
        clone = object.__new__(type(fmu))
        for name in STANDS:
            setattr(clone, name, getattr(fmu, name))
        clone.messages = []
        vars(clone).update(attributes_like(values, loads, constant, unchanging))
        time = recording.value("load", "d", n)
        step_size = recording.value("load", "d", n + 1)
        # Run the model's own step on symbols, arithmetic only.
        with only_arithmetic(type(fmu).__module__.partition(".")[0]):
            clone.step(time, step_size)
        # Compiled code has no log. An error makes C give up on this way; Python writes the message.
        if clone.messages:
            raise ValueError("it writes to the log")
        parameters = attributes_like(values, loads, constant, unchanging)
        # The attributes after a step; parameters are those of before, whatever they may have remembered meanwhile.
        mutable = {
            name: parameters[name] if name in unchanging else value
            for name, value in vars(clone).items()
        }
        return _changes(before, loads, mutable, constant, unchanging)

    root = recording.record(run)
    # C keeps one type a number, so no number may turn from whole to fraction.
    _check_kinds(before, root)
    names = {(v.name,) for v in fmu.variables if v.causality == "output" and v.type == "Real"}
    outputs = frozenset(place for place, leaf in enumerate(before.leaves) if leaf.path in names)
    return Step(recording, root, outputs)


def remember(parameters: Any) -> None:
    """Let a dataclass compute its cached properties, so that they belong to the memory."""
    for cls in type(parameters).__mro__:
        for name, item in vars(cls).items():
            if isinstance(item, cached_property):
                getattr(parameters, name)


def _changes(before: Flat, loads: list[Symbol], values: Mapping[str, Any], constant, unchanging):
    # Compare the state after the step with that before; only numbers that changed are written.
    after = Flat(values, constant, unchanging)
    if not after.same_shape(before):
        raise Untraceable(f"its state changes its shape: {before.difference(after)}")
    for number in after.numbers:
        loads[0].recording.refuse_left_behind(number)
    pairs = zip(before.leaves, loads, after.numbers, strict=True)
    return [
        (place, number)
        for place, (leaf, load, number) in enumerate(pairs)
        if number is not load and leaf.path[0] not in unchanging
    ]


def _check_kinds(before, root):
    """Refuse whole numbers that become fractions: C would cut them off."""
    for end in ends(root):
        for place, number in end.result if isinstance(end.result, list) else ():
            if before.leaves[place].kind != "d" and kind_of(number) == "d":
                raise Untraceable(
                    f"{text_of(before.leaves[place].path)} is a whole number before a step and none after"
                )
