"""A study beside the same runs alone: what it costs on top, how many ship-seconds a second it does, two processes."""

import resource
import time
from pathlib import Path

import pytest

import shipcosim
from shipcosim.sweep import plan_of, read_study, run_study
from speed.measure import reported

ROUNDS = 3
STUDY = """
scenario  = "stationkeeping"
stop_time = {length}

[[factor]]
name  = "seed"
seeds = {runs}

[[quantity]]
name   = "farthest"
signal = ["vessel.x", "vessel.y"]
near   = [0.0, 0.0]
reduce = "maximum"
"""


@pytest.fixture
def plan(tmp_path):
    def of(runs, length):
        (tmp_path / "timed.toml").write_text(STUDY.format(runs=runs, length=float(length)))
        return plan_of(read_study(tmp_path / "timed.toml"))

    return of


def cpu():
    """CPU time of this process and of those that have ended. [s]"""
    uses = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(use.ru_utime + use.ru_stime for use in uses)


def spent(function, clock=cpu):
    start = clock()
    function()
    return clock() - start


def swept(plan, folder: Path, workers=1):
    runs = run_study(plan, folder, workers=workers, force=True, again=True).runs
    assert len(runs) == len(plan) and not runs["error"].any()


def test_a_run_of_a_study_costs_less_than_ten_milliseconds_on_top(plan, tmp_path):
    few, many, length = 20, 220, 5.0

    def alone(runs):
        seeds = [dict(one.values) for one in map(plan(runs, length).run, range(runs))]
        scenario = shipcosim.read_scenario("stationkeeping").model_copy(
            update={"stop_time": length, "expect": [], "events": []}
        )
        kept = shipcosim.simulate_many(None, scenario, seeds, record=["vessel.x", "vessel.y"])
        assert not any(kept.error.values)

    swept(plan(few, length), tmp_path / "first")
    on_top = []
    for number in range(ROUNDS):
        study = [
            spent(lambda n=n, k=number: swept(plan(n, length), tmp_path / f"{k}-{n}"))
            for n in (few, many)
        ]
        same = [spent(lambda n=n: alone(n)) for n in (few, many)]
        on_top.append(1000.0 * ((study[1] - study[0]) - (same[1] - same[0])) / (many - few))
    assert (
        reported(
            "CPU time of a run of a study over that of the same variation alone", on_top, "ms", "10"
        )
        < 10.0
    )


def test_two_processes_do_nearly_twice_as_much(plan, tmp_path):
    runs, length = 200, 300.0
    swept(plan(4, length), tmp_path / "first")
    ratios, throughput = [], []
    for number in range(ROUNDS):
        clock = {}
        for n in (1, 2):
            folder = tmp_path / f"{number}-{n}"
            clock[n] = spent(
                lambda n=n, to=folder: swept(plan(runs, length), to, n), time.perf_counter
            )
        ratios.append(clock[1] / clock[2])
        throughput.append(runs * length / clock[1])
    reported(
        "ship-seconds a second on one core, start of the worker included",
        throughput,
        "",
        "as many as can be",
    )
    assert reported("time of one process over that of two", ratios, "", "1.8") >= 1.5
