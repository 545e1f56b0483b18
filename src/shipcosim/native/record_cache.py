"""Cache of recorded steps: a record follows from code and shape, and seldom from numbers."""

from __future__ import annotations

import hashlib
import pickle
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import shipcosim
from shipcosim.library import cache
from shipcosim.native.number_rows import Flat
from shipcosim.native.trace import Shape, Step
from shipcosim.temporary import replace_file


class KeptCall(NamedTuple):
    """A function that stays in Python.

    Parameters
    ----------
    module, name : str
        Where it is found.
    arguments : tuple
        An example of its arguments.
    changing : list of int
        Which of the numbers in them change.
    size : int
        How many numbers it gives.
    """

    module: str
    name: str
    arguments: tuple
    changing: list[int]
    size: int

    @property
    def function(self) -> Callable:
        """The function itself, without its cache."""
        function = getattr(sys.modules[self.module], self.name)
        return getattr(function, "__wrapped__", function)


@dataclass(frozen=True)
class Record:
    """The record of a compiled step, or of one that cannot be compiled.

    Parameters
    ----------
    source : str
        Its C text; empty where there is a refusal.
    calls : list of KeptCall
        Functions that stay in Python.
    guards : dict of int to str
        Places in the memory on whose numbers the code relies, and those numbers, rounded.
    refusal : str
        Why the step cannot be compiled; empty where it can.
    """

    source: str
    calls: list[KeptCall]
    guards: dict[int, str]
    refusal: str = ""

    @cached_property
    def examples(self) -> list[Flat]:
        """Arguments of the functions that stay in Python, taken apart."""
        return [Flat(call.arguments) for call in self.calls]


def record_of(step: Step, source: str, numbers: Sequence[float]) -> Record:
    """Build the record of a step that was recorded from some numbers."""
    calls = [
        KeptCall(
            call.function.__module__,
            call.function.__name__,
            call.arguments,
            call.changing,
            len(Flat(call.result).numbers),
        )
        for call in step.recording.calls
    ]
    return Record(
        source, calls, {place: _rounded(numbers[place]) for place in sorted(_guarded(step))}
    )


def refusal_of(why: str, numbers: Sequence[float]) -> Record:
    """The record of a step that cannot be compiled from some numbers: finding that out may take ten seconds."""
    return Record("", [], {place: _rounded(number) for place, number in enumerate(numbers)}, why)


def key_of(fmu: Any, shape: Shape) -> str:
    """Key of a component's code and shape. An FMU's module name is unique to its content."""
    return _key(type(fmu).__module__, type(fmu).__qualname__, shape.flat)


@lru_cache(maxsize=256)
def _key(module, name, flat):
    # Another version, another shape or another code writer gives another key.
    parts = module, name, shipcosim.__version__, flat.structure, flat.leaves, OWN_CODE
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]


def kept_record(key: str, numbers: Sequence[float]) -> Record | None:
    """Return the cached record that fits some numbers."""
    path = _path(key)
    # First the records in memory; the file is read again only if none of them fits.
    if (record := _fitting(_READ.get(path, ()), numbers)) is not None:
        return record
    _READ[path] = _records_in(path)
    return _fitting(_READ[path], numbers)


_READ: dict[Path, list[Record]] = {}
"""Records that this process has read."""


def _records_in(path: Path) -> list[Record]:
    """Records of a file of the cache; none where it is missing, damaged or old: the step is recorded again."""
    try:
        content = path.read_bytes()
        digest = content[:DIGEST]
        records = content[DIGEST:]
        return pickle.loads(records) if hashlib.sha256(records).digest() == digest else []
    except (OSError, AttributeError, ImportError):
        return []


def _fitting(records, numbers):
    """The first record whose guarded numbers are the given ones."""
    fitting = (
        record
        for record in records
        if all(_rounded(numbers[place]) == value for place, value in record.guards.items())
    )
    return next(fitting, None)


def keep_record(key: str, record: Record) -> None:
    """Add a record to the cached ones of its key. A cache that cannot be written keeps nothing."""
    path = _path(key)
    try:
        # The newest first; old ones drop out beyond the limit.
        records = pickle.dumps([record, *_records_in(path)][:MOST])
        replace_file(path, hashlib.sha256(records).digest() + records)
    except (OSError, pickle.PicklingError, AttributeError):
        return


MOST = 8
"""Records that are kept of one shape."""
DIGEST = 32
"""Length of the digest at the head of a file, by which damage is seen. [bytes]"""


def _guarded(step: Step) -> set[int]:
    """Places in the memory that determine the whole numbers in the code."""
    # A guarded value may be computed; guard the loads that it comes from.
    sources = (source for symbol in step.recording.relied_on for source in symbol.sources())
    return {source.operands[0] for source in sources if source.op == "load"}


def _rounded(number):
    return f"{number:.9g}"  # as a text, so that NaN equals NaN


def _path(key) -> Path:
    return cache() / "native" / f"{key}.record"


def _own_code() -> str:
    """Hash of this package, which writes the C texts."""
    files = sorted(Path(__file__).parent.rglob("*.[pch]*"))
    texts = [path.read_bytes() for path in files if path.suffix in (".py", ".c", ".h")]
    return hashlib.sha256(b"\0".join(texts)).hexdigest()


OWN_CODE = _own_code()
"""What keys of the cache hold: another package writes other texts."""
