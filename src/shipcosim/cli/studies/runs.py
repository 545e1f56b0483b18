"""A study's page on this machine, where a click on a row simulates its run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from shipcosim.cli.console import shown_path
from shipcosim.cli.runs import print_run, run_with_progress
from shipcosim.cli.terminal import make_console

if TYPE_CHECKING:
    from shipcosim.calls.studies import PlannedStudy
    from shipcosim.results.study import StudyResult


def serve(study: PlannedStudy, swept: StudyResult, port: int = 0) -> None:
    """Show the page of a study, where a click on a row simulates it, until Ctrl-C.

    Parameters
    ----------
    study : PlannedStudy
    swept : StudyResult
        Its results.
    port : int
        0: one that is free.

    Raises
    ------
    ShipcosimError
        If the port cannot be used.
    """

    from shipcosim.report.study.server import study_server

    def simulate(number: int) -> bool:
        folder = swept.folder / f"run-{number}"
        result = run_with_progress(study.prepare(number), folder, force=True)
        print_run(result, folder)
        return result.passed

    numbers = [int(number) for number in swept.runs["run"]]
    server = study_server(swept.folder, numbers, simulate, port)
    make_console(soft_wrap=True).print(
        f"{shown_path(swept.folder)} is shown at {server.url} on this machine; Ctrl-C ends it."
    )
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
