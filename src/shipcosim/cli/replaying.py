"""The command `replay`: the errors of predictions of a log, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from shipcosim.cli.console import say_page
from shipcosim.cli.tables import print_table
from shipcosim.cli.terminal import make_console

if TYPE_CHECKING:
    from shipcosim.diagnose.replays import LogReplay


def print_replay(replay: LogReplay, folder: Path) -> None:
    """The errors, and what was handled in the log, on stdout."""
    from shipcosim.diagnose.validation.tracks import errors_of
    from shipcosim.report.diagnosis.track_figures import error_rows
    from shipcosim.report.replay.page import remarks_of, replay_outcome

    console = make_console(soft_wrap=True)
    errors = error_rows(errors_of(replay.tracks))
    console.print(replay_outcome(replay).sentence)
    print_table(console, errors.rows, errors.head)
    for remark in remarks_of(replay):
        console.print(Text(remark, style="yellow"))
    say_page(console, folder / "report.html")
