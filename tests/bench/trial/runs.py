"""Draws logs, has them diagnosed, and writes a JSON line for each, so that a run can be stopped and taken up again."""

import contextlib
import importlib
import itertools
import json
import subprocess
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from functools import cache, lru_cache
from multiprocessing import get_context
from pathlib import Path

import shipcosim
from trial.poor import poorer
from trial.scoring import DATA_FAULTS
from trial.tools import reference_of, twin_of
from truth import draw, draw_many
from truth.cases import CAUSES

KINDS = ("trial", "work", "hold")
TOOL = "trial.tools:ours"
REFERENCED = (
    "form_reference",
    "healthy_form_reference",
)  # sets with a sea trial of another day, the ship well
TOOLS = {"drift": "trial.tools:with_drift"}  # of the sets that others are for
TOOLS |= dict.fromkeys(REFERENCED, "trial.tools:with_reference_log")
BATCH = 16
DRIFT = {"legs": [[30, 0, 0, 0], [300, 0, 0, 0]], "free": [[30, 330]]}  # five minutes without power
ALIKE = (
    "current",
    "tow",
    "wave_drift",
    "thrust_loss",
    "rpm_offset",
    "azimuth_offset",
    "reverse_loss",
    "wind_scale",
)
"""Causes that look like another one in a few minutes in which a ship does little."""
POOR = {
    "slow_2s": {"every": 2},
    "slow_3s": {"every": 3},
    "slow_5s": {"every": 5},
    "slow_10s": {"every": 10},
    "brief_20s": {"seconds": 20},
    "brief_45s": {"seconds": 45},
    "brief_120s": {"seconds": 120},
    "position": {"channels": "position"},
    "no_velocity": {"channels": "no_velocity"},
    "no_velocity_no_wind": {"channels": "no_velocity_no_wind"},
    "half_channels": {"channels": "half"},
}
"""What is left of a log in the sets of poor ones, as the arguments of `poorer`."""
SETS = {
    "one": {},
    "healthy": {"causes": 0},
    "unknown": {"causes": "unknown"},
    "two": {"causes": 2},
    "data": {"among": list(DATA_FAULTS)},
    "clock": {"causes": 2, "always": "clock"},
    "clock_alone": {"among": ["clock"]},
    "alike": {"among": list(ALIKE), "minutes": 10, "poor": {"since": 360}},
    "half": {"size": 0.5},
    "short": {"minutes": 20},
    "onset": {"onset": True},
    "mismatch": {"mismatch": 2.0},
    "rough": {"rough": True},
    "form": {"form": 1.0},
    "healthy_mismatch": {"causes": 0, "mismatch": 2.0},
    "healthy_rough": {"causes": 0, "rough": True},
    "healthy_form": {"causes": 0, "form": 1.0},
    "form_reference": {"form": 1.0},
    "healthy_form_reference": {"causes": 0, "form": 1.0},
    "drift": {"among": [cause for cause in CAUSES if cause not in DATA_FAULTS], "after": DRIFT},
    **{name: {"poor": poor} for name, poor in POOR.items()},
    **{f"healthy_{name}": {"causes": 0, "poor": poor} for name, poor in POOR.items()},
}


def run(kinds, sets, seeds, into, *, tool=None, jobs=1, minutes=None, progress=print):
    """Diagnose every log of a plan that is not in the results yet.

    Parameters
    ----------
    kinds, sets : sequence of str
        Of `KINDS` and `SETS`.
    seeds : sequence of int
        Each is drawn once for each kind and set.
    into : path
        JSON lines; what is there already is not done again, new lines are appended.
    tool : str, optional
        ``module:function`` that makes a `Diagnosis` of the path of a log; `TOOL`, or that of the set in `TOOLS`.
    jobs : int
        Processes.
    minutes : float, optional
        No new batch is begun after this long.
    progress : callable
        Called with each result, and with how many there are to come in all.

    Returns
    -------
    list of dict
        All results of the file that belong to the plan.
    """
    into, until = Path(into), time.monotonic() + 60.0 * (minutes or 1e9)
    into.parent.mkdir(parents=True, exist_ok=True)
    done = {key(result) for result in read_results(into)}
    plan = set(itertools.product(kinds, sets, seeds))
    with pool_of(jobs) as pool:
        for batch in (seeds[i : i + BATCH] for i in range(0, len(seeds), BATCH)):
            for kind, name in itertools.product(kinds, sets):
                wanted = [seed for seed in batch if (kind, name, seed) not in done]
                if not wanted or time.monotonic() > until:
                    continue
                for result in diagnosed(
                    kind, name, wanted, tool=tool or TOOLS.get(name, TOOL), pool=pool
                ):
                    add(result, into)
                    progress(result, len(plan - done))
    return [result for result in read_results(into) if key(result) in plan]


def pool_of(jobs):
    """Processes for `diagnosed`; none for one job."""
    return (
        ProcessPoolExecutor(jobs, mp_context=get_context("spawn"))
        if jobs > 1
        else contextlib.nullcontext()
    )


def diagnosed(kind, name, seeds, *, tool=TOOL, pool=None):
    """Draw the logs of one kind and set, and diagnose each.

    Yields
    ------
    dict
        `kind`, `set`, `options`, `seed`, `answer` (what is hidden), `span` of the log [s], `tool`, `diagnosis` (None
        after an error), `error`, `seconds`.
    """
    cases = drawn(kind, seeds, SETS[name])
    yield from answered([(case, name, SETS[name]) for case in cases], tool=tool, pool=pool)


def drawn(kind, seeds, options):
    """Logs of a kind by the options of a set: those of `truth.draw_many`, and what is left of a poor log."""
    if "poor" not in options:
        return draw_many(kind, seeds, **options)
    rest = {key: value for key, value in options.items() if key != "poor"}
    return [
        poorer(case, **options["poor"]) for case in _whole(kind, tuple(seeds), json.dumps(rest))
    ]


@lru_cache(maxsize=2)
def _whole(kind, seeds, options):
    """The logs of which those of the sets of poor ones are parts; each such set of one kind is of the same."""
    return draw_many(kind, seeds, **json.loads(options))


def answered(cases, *, tool=TOOL, pool=None):
    """Diagnose drawn logs, each with its set and the options that it was drawn with; yields as `diagnosed`."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [
            str(Path(folder) / f"{case.kind}-{name}-{case.seed}.csv") for case, name, _ in cases
        ]
        for (case, name, _), path in zip(cases, paths, strict=True):
            case.save(path)
            if name == "drift":
                case.twin().save(twin_of(path))
            if name in REFERENCED:
                reference_log(case).save(reference_of(path))
        each = pool.map if pool else map
        outcomes = each(outcome_of, paths, itertools.repeat(tool))
        for (case, name, options), outcome in zip(cases, outcomes, strict=True):
            times = case.log["time [s]"]
            yield {
                "kind": case.kind,
                "set": name,
                "options": options,
                "seed": int(case.seed),
                "answer": json.loads(
                    json.dumps([answer._asdict() for answer in case.answer], default=float)
                ),
                "span": [float(times.min()), float(times.max())],
                "tool": tool,
                **outcome,
            }


def reference_log(case):
    """A sea trial of the ship of a log on another day, on which she is well."""
    return draw(
        "trial", case.seed, causes=0, form=SETS[REFERENCED[0]]["form"], day=1, ship=case.kind
    )


def outcome_of(path, tool=TOOL):
    """Diagnosis of one log as JSON, with the time it took; an error is a result too."""
    module, function = tool.split(":")
    diagnose = getattr(importlib.import_module(module), function)
    start, diagnosis, error = time.monotonic(), None, None
    try:
        diagnosis = json.loads(json.dumps(diagnose(path).as_json(), default=float))
    except Exception as failure:  # whatever it is, the trial goes on and counts it as a miss
        error = f"{type(failure).__name__}: {failure}"
    return {"diagnosis": diagnosis, "error": error, "seconds": round(time.monotonic() - start, 2)}


def add(result, into):
    """Append a result to a file, with the version of the project."""
    _end_line(into)
    with into.open("a", encoding="utf-8") as file:
        file.write(json.dumps(result | {"version": _version()}) + "\n")


def read_results(path):
    """Results in a file of JSON lines; lines that were cut off are left out."""
    if not Path(path).is_file():
        return []
    found = []
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        with contextlib.suppress(json.JSONDecodeError):
            found.append(json.loads(line))
    return found


def key(result):
    """Kind, set and seed of a result."""
    return result["kind"], result["set"], result["seed"]


def _end_line(path):
    """End a last line that was cut off, so that the next is not appended to it."""
    if path.is_file() and not path.read_bytes().endswith(b"\n"):
        with path.open("a", encoding="utf-8") as file:
            file.write("\n")


@cache
def _version():
    """Version of the project, with the commit where it is a working copy."""
    command = ["git", "describe", "--always", "--dirty"]
    try:
        commit = subprocess.run(
            command, cwd=Path(__file__).parent, capture_output=True, text=True, check=True
        ).stdout
    except (OSError, subprocess.CalledProcessError):
        return shipcosim.__version__
    return f"{shipcosim.__version__} ({commit.strip()})"
