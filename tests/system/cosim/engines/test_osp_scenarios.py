"""Scenario files of OSP in a run: what they do is what libcosim does with them."""

import pytest
from osp_events import DEFAULTS, EVENTS, written

from shipcosim.cosim import simulate
from shipcosim.scenario.osp import read_osp_scenario


@pytest.mark.parametrize("suffix", [".json", ".yaml"])
@pytest.mark.parametrize("end", [None, 0.2, 0.72, 100.0])
def test_events_defaults_and_end_act_as_in_libcosim(
    make_system, make_scenario, tmp_path, suffix, end
):
    pytest.importorskip("libcosimpy.CosimExecution", reason="needs libcosim")
    from osp_execution import assert_same, rows_of

    from shipcosim.cosim.export.osp import write_osp

    system = make_system(
        {"plant": ("integrator", {"y_start": 0.3}), "law": ("gain", {"factor": -0.9})},
        ["plant.y -> law.u", "law.y -> plant.u"],
    )
    more = {} if end is None else {"end": end}
    file = written(
        tmp_path / f"events{suffix}", description="five", defaults=DEFAULTS, events=EVENTS, **more
    )
    scenario = make_scenario(1.2, 0.05)
    read = read_osp_scenario(file, 0.05, 1.2)
    assert read.description == "five"
    assert [problem.found[:18] for problem in read.remarks] == (
        [] if end else ["It has no end: as "]
    )
    write_osp(system, scenario, tmp_path / "osp")
    table = simulate(system, scenario.model_copy(update={"events": read.events}))
    assert_same(table, rows_of(tmp_path / "osp", system, 24, file))
