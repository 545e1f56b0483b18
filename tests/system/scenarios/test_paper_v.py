"""The neural allocator of paper V in its scenarios."""

import numpy as np


def test_it_commands_the_thrusters_once_a_second_and_meets_the_request_roughly(load_scenario, run):
    table = run(load_scenario("allocation/paper_v_stationkeeping", stop_time=30.0))
    thrust = table["allocator.tunnel_thrust_cmd"].values
    changes = np.flatnonzero(np.diff(thrust) != 0.0)
    assert len(changes) >= 29 and set(np.diff(changes)) == {2}  # rows are 0.5 s apart
    late = table.sel(time=slice(15.0, 30.0))
    assert float(abs(late["allocator.slack_Y"]).mean()) < 0.3 * float(
        abs(late["allocator.tau_Y"]).mean()
    )
