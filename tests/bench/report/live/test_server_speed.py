"""How fast a server steps a system that no page can run: figures of docs/live.md."""

import threading
import time
from contextlib import suppress

from report.live.test_server import advance, socket, step_of, told

from shipcosim.calls.arguments import Reading, system_and_scenario
from shipcosim.live import LiveRun, LiveServer
from shipcosim.report.live import prepared, server_page
from speed.measure import reported

ROUNDS, SECONDS = 3, 200.0


def test_a_system_with_a_network_runs_twenty_times_real_time():
    system, scenario, _ = system_and_scenario("allocation/paper_v_four_corner", Reading(), {})
    steps = round(SECONDS / scenario.step_size)
    with LiveServer(server_page(system, scenario)) as server:
        run = LiveRun(*prepared(system, scenario), server, print)

        def work():
            with suppress(KeyboardInterrupt):
                run.run()

        def stop():
            raise KeyboardInterrupt

        thread = threading.Thread(target=work)
        thread.start()
        speeds = []
        with socket(server) as page:
            told(page, "run")
            for number in range(ROUNDS):
                begin = time.perf_counter()
                page.send(advance((number + 1) * steps))
                while step_of(page) < (number + 1) * steps - 20:
                    pass
                speeds.append(SECONDS / (time.perf_counter() - begin))
        run._check_interrupt = stop
        thread.join()
    assert reported("server", speeds, "times real time", "20") > 20.0
