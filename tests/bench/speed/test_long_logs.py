"""Time and memory of long logs: a whole diagnosis, beside that of 40 minutes; a fit in parts, beside one in one piece.

Each measurement of memory is that of a process of its own: its largest resident size. CPU time is counted, as the
machine may be shared. Logs are drawn from the independent truth; the fits take four hours at 1 Hz as they are.
"""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
MINUTES, SEED = 240, 5900
LESS_MEMORY, MOST_MEMORY, MOST_TIME = 1.3, 600.0, 1.8  # 1, MB, 1
LONG_MINUTES, LONG_MEMORY, LONG_TIME = (
    1667,
    1000.0,
    240.0,
)  # 100 020 rows; MB, s of CPU: two minutes of two cores


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    from truth import draw_many

    path = tmp_path_factory.mktemp("long") / "log.csv"
    draw_many("work", [SEED], minutes=MINUTES, causes=0)[0].save(path)
    return path


def test_parts_need_less_memory(log):
    whole, parts = measured(log, 10**9), measured(log, 4096)
    print(
        f"\n{MINUTES * 60} rows in one piece: {whole[0]:.0f} MB, {whole[1]:.1f} s CPU; in parts: {parts}"
    )
    assert parts[2] == pytest.approx(whole[2], rel=1e-9)  # the same score
    assert whole[0] / parts[0] >= LESS_MEMORY and parts[0] <= MOST_MEMORY
    assert parts[1] <= MOST_TIME * whole[1]


def test_a_hundred_thousand_rows_are_diagnosed_in_a_gigabyte_and_four_minutes_of_processor(
    tmp_path,
):
    """Forty times as many rows as in 40 minutes; what is computed for the ship grows by no more than 2.5."""
    from truth import draw

    figures = []
    for minutes in (40, LONG_MINUTES):
        path = tmp_path / f"{minutes}.csv"
        draw("trial", SEED, minutes=minutes, causes=0).save(path)
        figures.append(measured(path, "whole"))
    (_, short, _), (memory, seconds, _) = figures
    print(
        f"\n{LONG_MINUTES * 60} rows: {memory:.0f} MB, {seconds:.0f} s CPU, {seconds / short:.1f} times 40 minutes'"
    )
    assert memory <= LONG_MEMORY and seconds <= LONG_TIME


def test_fits_side_by_side_cost_no_more_processor_time():
    """Up to a fifth: threads wait for each other. The results are equal, which a test beside the sources holds."""
    from diagnose import twin

    from shipcosim.diagnose.inference import workers
    from shipcosim.diagnose.inference.fitting import fitted
    from speed.measure import cpu_seconds, reported

    problem = twin.problem("healthy")
    causes = [(one,) for one in problem.hypotheses[:8]]
    alone = lambda: [fitted(problem, one) for one in causes]  # noqa: E731
    together = lambda: workers.each(lambda one: fitted(problem, one), causes)  # noqa: E731
    alone()
    ratios = [cpu_seconds(together) / cpu_seconds(alone) for _ in range(5)]
    assert reported("fits in threads over fits in turn", ratios, "times the CPU time", "1.2") <= 1.2


def measured(log, part):
    """Memory [MB], CPU time [s] and score of a fit to a log, in a process of its own, in parts of so many rows.

    Or of a ``"whole"`` diagnosis of it; its score is the number of findings.
    """
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    command = [sys.executable, __file__, str(log), str(part)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return tuple(map(float, done.stdout.split()[-3:]))


def main(log, part):
    """A fit and a first look at all causes; the process's memory, its CPU time for both and the score, printed."""
    from shipcosim.diagnose.inference import parts
    from shipcosim.diagnose.inference.fitting import fitted
    from shipcosim.diagnose.inference.problem import identification_problem
    from shipcosim.diagnose.inference.screening import screened
    from shipcosim.diagnose.log.repair import repaired
    from shipcosim.diagnose.pipeline import read_measurements
    from shipcosim.ssp import read_system
    from speed.measure import cpu_seconds

    parts.PART, parts._ENTRIES = part, part * 64
    parts._KEPT = parts._KEPT if part < 10**6 else 10**12
    read = read_measurements(
        log, read_system(ROOT / "ssp" / "gunnerus_open", fmus=[ROOT / "build" / "fmus"])
    )
    table = repaired(read.log)
    short = identification_problem(
        table.isel(time=slice(0, 1200)), read.ship, read.causes
    )  # compiles, and has the noise
    problem, found = identification_problem(table, read.ship, read.causes, short.noise), []
    seconds = cpu_seconds(lambda: found.append(fitted(problem)))
    seconds += cpu_seconds(lambda: screened(problem, found[0]))
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, seconds, found[0].score)


def whole(log):
    """A whole diagnosis; the process's memory, its CPU time and the number of findings, printed."""
    from shipcosim.diagnose.pipeline import diagnose
    from shipcosim.ssp import read_system
    from speed.measure import cpu_seconds

    found = []
    system = read_system(ROOT / "ssp" / "gunnerus_open", fmus=[ROOT / "build" / "fmus"])
    seconds = cpu_seconds(lambda: found.append(diagnose(log, system)))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(memory, seconds, len(found[0].findings))


if __name__ == "__main__":
    sys.path[:0] = [str(Path(__file__).resolve().parents[1])]
    if sys.argv[2] == "whole":
        whole(sys.argv[1])
    else:
        main(sys.argv[1], int(sys.argv[2]))
