"""A real Dask cluster of two worker processes: the same table as on this machine, also where a worker is killed."""

import os
import signal
import sys
from concurrent.futures import Future
from pathlib import Path
from types import SimpleNamespace

import pandas
import pytest

import shipcosim
from shipcosim.errors import ShipcosimError
from shipcosim.sweep import dispatch, workers

DASK = Path(__file__).resolve().parents[3] / ".venv" / "cluster"


@pytest.fixture(autouse=True)
def dask(monkeypatch):
    # As in the Makefile: Dask has a folder of its own, which processes of workers are told too.
    monkeypatch.setattr(sys, "path", [*sys.path, str(DASK)])


@pytest.fixture
def cluster(dask):
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as found:
        yield found


SLOW = 'extends = "levels"\n[set]\n"lag.pause" = 0.2\n'


def test_a_cluster_gives_the_same_table_also_where_a_worker_is_killed(project, study, cluster):
    path, killed = study(SLOW), []
    here = shipcosim.sweep(path, out="here", engine="fmpy", workers=2)

    def kill_one(done, total):
        if done >= 3 and not killed:
            killed.append(next(worker.pid for worker in cluster.workers.values()))
            os.kill(killed[0], signal.SIGKILL)

    there = shipcosim.sweep(
        path, out="there", engine="fmpy", scheduler=cluster.scheduler_address, progress=kill_one
    )
    assert killed
    pandas.testing.assert_frame_equal(there.runs, here.runs)


def test_a_killed_process_of_this_machine_costs_no_run(project, study):
    path = study(SLOW)
    whole = shipcosim.sweep(path, out="whole", engine="fmpy", workers=2)
    killed = []

    def kill_one(done, total):
        if done >= 3 and not killed:
            import multiprocessing

            killed.append(multiprocessing.active_children()[0].pid)
            os.kill(killed[0], signal.SIGKILL)

    found = shipcosim.sweep(path, out="killed", engine="fmpy", workers=2, progress=kill_one)
    assert killed
    pandas.testing.assert_frame_equal(found.runs, whole.runs)


def test_a_scheduler_that_is_not_there_is_said(project, monkeypatch):
    import distributed

    # One second of waiting shows it as well as ten.
    real = distributed.Client
    monkeypatch.setattr(
        distributed, "Client", lambda address, **options: real(address, **options | {"timeout": 1})
    )
    with pytest.raises(ShipcosimError, match="No scheduler of Dask answers"):
        shipcosim.sweep("levels", out="out", engine="fmpy", scheduler="tcp://127.0.0.1:9")


def test_a_cluster_whose_workers_are_all_gone_is_said_and_what_is_done_stays(
    project, study, cluster
):
    path, killed = study(SLOW), []

    def kill_all(done, total):
        if done >= 3 and not killed:
            cluster.scale(0)
            killed.extend(worker.pid for worker in cluster.workers.values())
            for pid in killed:
                os.kill(pid, signal.SIGKILL)

    with pytest.raises(ShipcosimError, match="answers no more.*the same command, which goes on"):
        shipcosim.sweep(
            path,
            out="lost",
            engine="fmpy",
            scheduler=cluster.scheduler_address,
            progress=kill_all,
        )
    assert killed
    assert len(shipcosim.sweep(path, out="lost", engine="fmpy", at_most=0).runs) >= 3


def test_a_scheduler_that_keeps_what_is_to_be_done_but_has_no_worker_is_left(monkeypatch):
    """Dask queues tasks for workers that may come: their futures never end, where the last worker has gone."""
    monkeypatch.setattr(dispatch, "CHECKED", 0.01)
    monkeypatch.setattr(workers, "PATIENCE", 0.05)
    listed = {"tcp://a:1": {}}
    cluster = object.__new__(workers.Cluster)
    cluster.n, cluster.ends, cluster._where = 1, (ConnectionError,), "--scheduler tcp://b:2"
    cluster._client = SimpleNamespace(scheduler_info=lambda n_workers: {"workers": listed})
    cluster._executor = SimpleNamespace(submit=lambda *_: Future())
    cluster._job = None
    checks = []

    def check():
        # The worker leaves only after some checks: while it is there nothing is given up.
        checks.append(len(listed))
        if len(checks) == 20:
            listed.clear()
        workers.Cluster.check(cluster)

    cluster.check = check
    plan = SimpleNamespace(run=lambda number: number)
    with pytest.raises(ShipcosimError, match="answers no more: it has had no worker for 0.05 s"):
        list(dispatch.Dispatch(plan, iter(range(3)), cluster).rows())
    assert len(checks) > 20


def test_workers_of_this_machine_beside_a_scheduler_are_refused(project):
    with pytest.raises(ShipcosimError, match="workers = 2, but the scheduler has workers"):
        shipcosim.sweep("levels", out="out", engine="fmpy", scheduler="tcp://a:1", workers=2)
