"""Functions with cached results and numeric primitives, recorded for C without Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from shipcosim.native.blocks import Block, Call, typed
from shipcosim.native.number_rows import Flat, made_like
from shipcosim.native.recording import Recording
from shipcosim.native.symbols import Symbol, Untraceable


class ExportRecording(Recording):
    """A recording for code without Python: functions with cached results are recorded too."""

    stands_alone = True
    most_ways = 60

    def __init__(self, *arguments: Any):
        super().__init__(*arguments)
        self._acting: set[int] = set()

    def acts(self, value: Any, neutral: float) -> bool:
        """Whether a parameter has an effect, as a question of the code."""
        question = value != neutral
        if isinstance(question, Symbol) and not self.is_choice(question):
            # Each answer is possible with each other: n questions have 2^n ways.
            self._acting.add(question.number)
            if 2 ** len(self._acting) > self.most_ways:
                raise Untraceable(
                    f"it leaves out what has no effect: {len(self._acting)} parameters decide"
                )
        return bool(question)


@dataclass(frozen=True, eq=False)
class Procedure:
    """A recorded function with cached results.

    Parameters
    ----------
    recording, root, outputs
        As of a `Step`; the memory are the arguments that change.
    """

    recording: Recording
    root: Block
    outputs: frozenset[int] = frozenset()


def described(call: Call) -> str:
    """A text that is equal for calls of which `procedure_of` makes the same."""
    given = Flat(call.arguments)
    function = call.function
    parts = function.__module__, function.__qualname__, given.structure, given.leaves, given.numbers
    return repr((*parts, call.changing))


def procedure_of(call: Call) -> Procedure:
    """Record a function with cached results."""
    given = Flat(call.arguments)
    # The memory of this recording is the function's changing arguments.
    recording = ExportRecording([given.numbers[place] for place in call.changing])

    def run():
        # Constant arguments keep their values; the changing ones become loads of the memory.
        numbers: list[Any] = [
            typed(number, leaf.kind)
            for number, leaf in zip(given.numbers, given.leaves, strict=True)
        ]
        symbols = [
            recording.value("load", given.leaves[place].kind, number)
            for number, place in enumerate(call.changing)
        ]
        for place, symbol in zip(call.changing, symbols, strict=True):
            numbers[place] = symbol
        results: list[Any] = Flat(call.function(*made_like(call.arguments, iter(numbers)))).numbers
        return list(enumerate(results))

    return Procedure(recording, recording.record(run))
