"""The state of a whole system in the middle of a run, in one file, from which any process can continue."""

import io
import json
import os
import zipfile
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from functools import partial
from math import inf, isfinite
from pathlib import Path
from sys import float_info
from typing import Any

from shipcosim.errors import AnyPath, error_at, reason_of
from shipcosim.scenario import step_times
from shipcosim.series import write_file

SCHEMA = "shipcosim-snapshot/1"
LARGEST = 1 << 30  # bytes of one FMU's state


@dataclass(frozen=True)
class Snapshot:
    """A system between two steps.

    Parameters
    ----------
    system : str
        Its name.
    start_time, step_size : float
        Of the run. [s]
    step : int
        Steps done.
    fmus : dict of str to str
        SHA-256 of each component's FMU.
    start_values : dict of str to value
        What the components were started with, by signal.
    outputs, inputs : dict of str to value
        Last values of the components' outputs, and what the connections brought to their inputs, by signal.
    changes : dict of str to (scale, shift)
        Overrides (0, value) and biases (1, value) in force, by signal.
    states : dict of str to bytes
        State of each component's FMU.
    """

    system: str
    start_time: float
    step_size: float
    step: int
    fmus: dict
    start_values: dict
    outputs: dict
    inputs: dict
    changes: dict
    states: dict

    @property
    def time(self) -> float:
        """Time at which the run was stored. [s]"""
        return float(step_times(self.step_size, self.step, self.step, self.start_time)[0])


def write_snapshot(snapshot: Snapshot, path: str | os.PathLike) -> None:
    """Write a snapshot into one file. Equal snapshots give equal bytes.

    Raises
    ------
    ShipcosimError
        If the file cannot be written.
    """
    facts = asdict(snapshot)
    states = facts.pop("states")
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        facts = {"schema": SCHEMA, **facts, "components": list(states)}
        archive.writestr(
            zipfile.ZipInfo("snapshot.json"), json.dumps(facts, indent=1, ensure_ascii=False)
        )
        for number, state in enumerate(states.values()):
            archive.writestr(zipfile.ZipInfo(f"{number}.state"), state)
    write_file(path, content.getvalue())


def read_snapshot(path: str | os.PathLike) -> Snapshot:
    """Read a snapshot. Whether it fits a system shows when a run continues from it.

    Raises
    ------
    ShipcosimError
        If the file cannot be read or is no snapshot.
    """
    path = Path(path)
    try:
        with zipfile.ZipFile(path) as archive:
            if any(member.file_size > LARGEST for member in archive.infolist()):
                raise ValueError(f"it holds a state of more than {LARGEST >> 20} MiB")
            facts = json.loads(archive.read("snapshot.json"))
            if facts.pop("schema") != SCHEMA:
                raise ValueError(f"its schema is not {SCHEMA}")
            states = {
                name: archive.read(f"{number}.state")
                for number, name in enumerate(facts.pop("components"))
            }
        if set(states) != set(facts.get("fmus", ())):
            raise ValueError("its components are others than those whose FMUs it names")
        return Snapshot(**_typed(facts), states=states)
    except OSError as error:
        raise error_at(str(path), f"cannot be read: {error.strerror or error}.") from error
    except Exception as error:  # of a damaged archive the decompressors raise anything
        raise error_at(
            str(path),
            f"is no snapshot of a run: {reason_of(error)}.",
            "Snapshots come from --store or simulate(..., store=...).",
        ) from error


def opened(snapshot: Snapshot | AnyPath | None) -> Snapshot | None:
    """The snapshot itself, read where it is a path.

    Raises
    ------
    ShipcosimError
        If the file cannot be read or is no snapshot.
    """
    return (
        snapshot if snapshot is None or isinstance(snapshot, Snapshot) else read_snapshot(snapshot)
    )


def writer(
    store: Callable[[Snapshot], object] | AnyPath | None,
) -> Callable[[Snapshot], object] | None:
    """The function that gets a run's snapshot: the one given, or one that writes into the file of a path.

    Raises
    ------
    ShipcosimError
        If the file's folder does not exist.
    """
    if store is None or callable(store):
        return store
    if not Path(store).absolute().parent.is_dir():
        raise error_at(
            str(store), "There is no such folder to store the state in.", "Make it first."
        )
    return partial(write_snapshot, path=store)


def _typed(facts):
    """The facts, each of the type that the snapshot declares."""
    kinds: dict[str, Any] = {
        field.name: field.type for field in fields(Snapshot) if field.name != "states"
    }
    if set(facts) != set(kinds):
        raise ValueError(f"it lacks or adds {', '.join(sorted(set(facts) ^ set(kinds)))}")
    for name, kind in kinds.items():
        if not isinstance(facts[name], (int, float) if kind is float else kind) or isinstance(
            facts[name], bool
        ):
            raise ValueError(f"{name} is {str(facts[name])[:100]}")
    if not (
        isfinite(facts["start_time"]) and 0.0 < facts["step_size"] < inf and facts["step"] >= 0
    ):
        raise ValueError("its times are none of a run")
    held = [
        *facts["outputs"].values(),
        *facts["inputs"].values(),
        *(v for two in facts["changes"].values() for v in two),
    ]
    if not all(isinstance(value, (int, float)) and abs(value) <= float_info.max for value in held):
        raise ValueError("it holds values that no signal has")
    return facts | {
        "changes": {signal: (scale, shift) for signal, (scale, shift) in facts["changes"].items()}
    }
