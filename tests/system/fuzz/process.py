"""A process that gives damaged inputs to the program: SEED, FIRST, LAST (which is not given), FOLDER.

It prints a line of JSON before and after each input. Memory is limited to 1 GiB beyond what the process has once
everything is imported. Around the folder that the program works in are others, in which nothing may change.
"""

import json
import os
import resource
import shutil
import sys
import tempfile
import time
import traceback
from pathlib import Path

if __name__ == "__main__":  # as a test its folders are on the path already
    sys.path[:0] = [str(folder) for folder in Path(__file__).resolve().parents[1:3]]

# Arrow's own pool reserves a GiB of addresses at the first text of pandas, which the limit on memory would count.
os.environ["ARROW_DEFAULT_MEMORY_POOL"] = "system"

from fuzz.inputs import write_input
from fuzz.seeds import seeds, zipped
from fuzz.typed import running

import shipcosim as sc
import shipcosim.report
from shipcosim.checks import check_any
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.reference.reference import read_reference
from shipcosim.errors import ShipcosimError
from shipcosim.series import read_columns

LONGEST = 10.0  # s of processor time
LARGEST = 2**30  # bytes
LONGEST_TEXT = (
    100_000  # characters of all that is said about one input: more than that nobody reads
)
ABSOLUTE = Path("/evil-from-archive")  # named by some archives


def main(seed, first, last, around):
    """Give inputs to the program and print how each ends."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # nobody else prints there
    around = Path(around)
    inside = around / "a" / "b" / "c" / "inside"
    tempfile.tempdir = str(inside / "tmp")
    _warm_up(inside)
    running()
    limit = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize() + LARGEST
    for number in range(int(first), int(last)):
        _empty(inside)
        path, how = write_input(number, inside / "given", seed)
        print(json.dumps({"number": number, "how": how}), file=out, flush=True)
        before = _files(around)
        resource.setrlimit(resource.RLIMIT_AS, (limit, resource.RLIM_INFINITY))
        ended, took = _ended(path, inside)
        resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        if took > LONGEST:
            ended = f"took {took:.1f} s"
        if (written := _files(around) ^ before) or ABSOLUTE.exists():
            ended = f"wrote {[name for name, *_ in written][:3] or ABSOLUTE}"
        print(
            json.dumps({"number": number, "how": how, "took": took, "ended": ended}),
            file=out,
            flush=True,
        )


def _empty(inside):
    shutil.rmtree(inside, ignore_errors=True)
    for name in ("tmp", "given", "out"):
        (inside / name).mkdir(parents=True)
    os.chdir(inside)


def _files(folder):
    """Names, sizes and times of all files but those that the program is told to write."""
    paths = [os.path.join(top, name) for top, _, names in os.walk(folder) for name in names]
    looked = [
        (path, os.stat(path)) for path in paths if f"{os.sep}inside{os.sep}out{os.sep}" not in path
    ]
    return {(path, stat.st_size, stat.st_mtime_ns) for path, stat in looked}


def _warm_up(inside):
    """Have sound files of all kinds read once, so that what is imported late is there."""
    _empty(inside)
    for kind in ("ssp", "csv", "fmu", "osp"):
        for name, data in seeds()[kind]:
            files = data if kind == "osp" else {name: zipped(data) if kind == "ssp" else data}
            for file, content in files.items():
                (inside / "given" / file).write_bytes(content)
            ended, _ = _ended(inside / "given" / name, inside, is_sabotaged=False)
            if kind in ("ssp", "osp") and ended != "success":
                raise SystemExit(f"{name} is to be sound, but: {ended}")
    import yaml  # noqa: F401


def _ended(path, inside, is_sabotaged=True):
    """How the program ends on an input, and the time of the longest of its commands. [s]"""
    actions = _actions_on(path)
    if is_sabotaged:
        actions.insert(0, lambda: exec(os.environ.get("SHIPCOSIM_FUZZ_SABOTAGE", "")))
    if path.suffix in (".ssp", ".ssd"):
        actions += _reading_and_writing(path, inside / "out" / "again.ssp")
    problems, longest = [], 0.0
    for action in actions:
        start = time.process_time()
        try:
            problems += action() or []
        except ShipcosimError as error:
            problems += error.problems
        except BaseException as error:
            frames = traceback.extract_tb(error.__traceback__)
            place = next(
                (frame for frame in reversed(frames) if "shipcosim" in frame.filename), frames[-1]
            )
            what = f"{type(error).__name__} in {Path(place.filename).name}, line {place.lineno}: {str(error)[:200]}"
            return what, time.process_time() - start
        longest = max(longest, time.process_time() - start)
    return _judged(problems), longest


def _actions_on(path):
    """What a user does with a file of a kind; what is said of it comes back."""
    if path.suffix == ".state":
        system = sc.read(running()[0])
        return [lambda: sc.simulate(system, stop_time=2.0, step_size=0.25, resume=path) and None]
    if path.suffix == ".reference":
        return [lambda: read_reference(path) and None]
    channels = path.with_name("channels.toml")
    actions = [lambda: check_any(str(path), channels if channels.exists() else None)]
    if path.suffix == ".nc":
        actions += [lambda: read_columns(path) and None, lambda: read_log(path) and None]
    return actions


def _judged(problems):
    errors = [problem for problem in problems if problem.severity == "error"]
    if (said := len(str(ShipcosimError(problems)))) > LONGEST_TEXT:
        return f"said {said} characters"
    if any(not problem.found.strip() for problem in errors):
        return "error without a word"
    return "clear error" if errors else "success"


def _reading_and_writing(path, again):
    """Commands that read a system to change it, write it, and read what was written."""
    system = []
    yield lambda: system.append(sc.read(str(path)))
    yield lambda: system and (system[0].checked(), system[0].write(again)) and None
    yield lambda: again.exists() and sc.read(again).checked() and None


if __name__ == "__main__":
    main(*sys.argv[1:])
