"""Results of training: weights as arrays in NAME.npz, report in NAME.json and NAME.md."""

import io
import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch

DATE = (1980, 1, 1, 0, 0, 0)  # of the files in an archive: the same weights are the same bytes


@dataclass(frozen=True)
class Trained:
    """A trained component.

    Parameters
    ----------
    arrays : mapping of str to array
            Weights, and further numbers that their evaluation needs, by name.
    description : str
        What was trained.
    seed : int
        Seed of data and weights.
    data : mapping
        What it was trained on: numbers and words, by name.
    settings : mapping
        Settings of the training, by name.
    epochs : sequence of mappings
        Losses of each epoch by name; empty where training has no epochs.
    notes : sequence of str
        What a reader of the report must know.
    """

    arrays: Mapping[str, np.ndarray]
    description: str
    seed: int
    data: Mapping[str, Any]
    settings: Mapping[str, Any]
    epochs: Sequence[Mapping[str, float]]
    notes: Sequence[str] = ()


def settings_of(recipe: Any, names: Sequence[str], optimiser: str) -> dict[str, Any]:
    """Settings of a training for its report.

    Parameters
    ----------
    recipe : any
        How it is trained.
    names : sequence of str
        Fields of the recipe that the report names.
    optimiser : str
        What minimises the loss.

    Returns
    -------
    dict of str
        Settings by name.
    """
    return {name: getattr(recipe, name) for name in names} | {"optimiser": optimiser}


def write_trained(
    trained: Trained, folder: Path, name: str, time: float = 0.0, processor_time: float = 0.0
) -> list[Path]:
    """Write weights and report.

    Parameters
    ----------
    trained : Trained
        What was trained.
    folder : Path
        Where to; it exists.
    name : str
        Name of the files, without suffix.
    time, processor_time : float
        That the training took, by the clock and of the processor. [s]

    Returns
    -------
    list of Path
        NAME.npz, NAME.json and NAME.md.
    """
    # The report also states how long training took.
    report = report_of(trained, name) | {
        "time_s": round(time, 1),
        "processor_time_s": round(processor_time, 1),
    }
    # Make all contents first, so that an error leaves no half-written set.
    contents = {
        ".npz": npz_bytes(trained.arrays),
        ".json": (json.dumps(report, indent=1, ensure_ascii=False) + "\n").encode(),
        ".md": markdown(report).encode(),
    }
    for suffix, content in contents.items():
        (folder / f"{name}{suffix}").write_bytes(content)
    return [folder / f"{name}{suffix}" for suffix in contents]


def npz_bytes(arrays: Mapping[str, np.ndarray]) -> bytes:
    """The arrays as an .npz file whose bytes depend on the arrays alone.

    Parameters
    ----------
    arrays : mapping of str to array
        The arrays.

    Returns
    -------
    bytes
        What `numpy.load` reads.
    """
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        # A fixed date in the archive: equal weights give equal bytes.
        for name, array in arrays.items():
            file = io.BytesIO()
            np.save(file, array, allow_pickle=False)
            info = zipfile.ZipInfo(f"{name}.npy", DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, file.getvalue())
    return content.getvalue()


def report_of(trained: Trained, name: str) -> dict[str, Any]:
    """The training report as what JSON can hold.

    Parameters
    ----------
    trained : Trained
        What was trained.
    name : str
        Its name.

    Returns
    -------
    dict
        Data, settings, seed, losses by epoch and versions.
    """
    from shipcosim import __version__

    return {
        "schema": "shipcosim-training/1",
        "name": name,
        "description": trained.description,
        "seed": trained.seed,
        "data": dict(trained.data),
        "settings": dict(trained.settings),
        "weights": int(sum(array.size for array in trained.arrays.values())),
        "notes": list(trained.notes),
        "versions": {"shipcosim": __version__, "torch": torch.__version__, "numpy": np.__version__},
        "epochs": [dict(epoch) for epoch in trained.epochs],
    }


def markdown(report: Mapping[str, Any]) -> str:
    """The training report as a page.

    Parameters
    ----------
    report : mapping
        As `report_of` gives it.

    Returns
    -------
    str
        Markdown.
    """
    versions = ", ".join(f"{name} {version}" for name, version in report["versions"].items())
    # Head: what was trained, with notes, size, seed and time.
    lines = [f"# {report['name']}", "", report["description"], ""]
    lines += [f"{note}\n" for note in report["notes"]]
    times = f"{report['time_s']:.0f} s by the clock, {report['processor_time_s']:.0f} s of one processor core"
    lines += [
        f"{report['weights']} numbers, seed {report['seed']}, trained in {times}, by {versions}."
    ]
    # Data and settings as tables.
    for title in ("data", "settings"):
        lines += ["", f"## {title.capitalize()}", "", "| | |", "|---|---|"]
        lines += [f"| {name} | {_text(value)} |" for name, value in report[title].items()]
    # Losses by epoch, where training has epochs.
    if report["epochs"]:
        names = list(report["epochs"][0])
        lines += [
            "",
            "## Losses by epoch",
            "",
            f"| epoch | {' | '.join(names)} |",
            "|---" * (len(names) + 1) + "|",
        ]
        for number, epoch in enumerate(report["epochs"], 1):
            lines.append(f"| {number} | {' | '.join(f'{epoch[name]:.4g}' for name in names)} |")
    return "\n".join(lines) + "\n"


def _text(value: Any) -> str:
    return ", ".join(map(_text, value)) if isinstance(value, (list, tuple)) else str(value)
