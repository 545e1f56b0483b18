"""The command `channels`: what each column of a log is, and the channel file that says so."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.calls.arguments import SYSTEM_OF_LOGS, Reading, check_inputs
from shipcosim.cli.terminal import make_console, say
from shipcosim.errors import ShipcosimError, error_at

if TYPE_CHECKING:
    from shipcosim.diagnose.log.names.proposal import Proposal


@dataclass(frozen=True)
class ProposedFile:
    """A proposal, remarks on the log, and the text of the channel file.

    Attributes
    ----------
    proposal : Proposal
    remarks : tuple of str
        How the file is read, and what reading it by the proposal says.
    text : str
        The channel file.
    """

    proposal: Proposal
    remarks: tuple[str, ...]
    text: str


def proposed(
    log: str | os.PathLike, system: str | None = None, form: str | os.PathLike | None = None
) -> ProposedFile:
    """Columns of a log with their roles.

    Parameters
    ----------
    log : path
        Measured data, or the table of a run.
    system : str, optional
        The ship, by whose thrusters columns are named; the default of `diagnose` without.
    form : path, optional
        Channel file of which the entry ``file`` is used.

    Raises
    ------
    ShipcosimError
        If the log or the system cannot be read.
    """
    from shipcosim.diagnose.log.channels import ChannelFile, read_channels
    from shipcosim.diagnose.log.files.file_layout import FileLayout
    from shipcosim.diagnose.log.names.channel_file import channel_file
    from shipcosim.diagnose.log.names.guesses import SURE, Guess
    from shipcosim.diagnose.log.names.proposal import propose
    from shipcosim.diagnose.log.reader import columns_of, read_log
    from shipcosim.diagnose.log.runs import channels_of_run
    from shipcosim.diagnose.ship.ship_of_system import ship_model_of

    check_inputs([log], form)
    given = read_channels(form).form if form is not None else FileLayout()
    columns = columns_of(log, given)
    ship = ship_model_of(Reading().system(system or SYSTEM_OF_LOGS, "system"))
    thrusters = {name: ship.drives(name) for name in ship.thrusters}
    proposal = propose(columns, thrusters, given)
    run_channels = channels_of_run(
        list(columns.values), ship.vessel, ship.thrusters, ship.thrust_signals
    )
    if run_channels:
        used = tuple(
            Guess(channel.column, role, channel, SURE) for role, channel in run_channels.items()
        )
        rest = [name for name in columns.values if name not in {guess.column for guess in used}]
        unused = tuple(Guess(name, why="another signal of the run") for name in rest)
        proposal = replace(proposal, used=used, unused=unused)
    remarks = list(columns.remarks)
    try:
        mapping = ChannelFile(proposal.channels(guessed=True), given)
        remarks += [
            remark
            for remark in read_log(log, mapping, thrusters).attrs["column_remarks"]
            if remark not in remarks
        ]
    except ShipcosimError as error:
        remarks += [
            f"The log cannot be read by this proposal yet: {problem}" for problem in error.problems
        ]
    return ProposedFile(proposal, tuple(remarks), channel_file(str(log), proposal, remarks))


def print_channels(proposed: ProposedFile) -> None:
    """Print the role of each column."""
    from rich.text import Text

    from shipcosim.cli.tables import print_table

    rows = []
    for guess in proposed.proposal.used:
        sure = Text("guess", style="yellow") if guess.is_guess else Text("used", style="green")
        why = "; ".join(filter(None, (guess.why, *guess.notes))) or "its name has one meaning"
        columns = " + ".join(guess.channel.columns)
        rows.append((columns, guess.role, sure, f"{guess.in_unit}{why}"))
    for guess in proposed.proposal.unused:
        rows.append((guess.column, "-", Text("not used", style="dim"), guess.why))
    console = make_console(soft_wrap=True)
    print_table(console, rows, ("column", "is", "", "because"))
    for remark in proposed.remarks:
        console.print(Text(remark, style="yellow"))


def print_isolability(log: Path, system: str | None, channels: Path | None) -> None:
    """Which causes the log could tell apart, on stdout.

    Raises
    ------
    ShipcosimError
        If the log cannot be read by the channel file or, without one, by the names of its columns.
    """
    from rich.text import Text

    from shipcosim.calls.logs import isolability
    from shipcosim.cli.tables import print_table

    words = {True: Text("yes", style="green"), False: Text("no", style="yellow")}
    rows = [
        (cause.label, words[cause.is_seen], ", ".join(cause.similar) or "-")
        for cause in isolability(log, system, channels)
    ]
    console = make_console(soft_wrap=True)
    if rows:
        print_table(console, rows, ("cause of typical size", "would show", "cannot be told from"))
    else:
        console.print(
            Text("This log cannot show causes: `shipcosim diagnose` says why.", style="yellow")
        )


def write_channels(proposed: ProposedFile, out: Path, force: bool = False) -> None:
    """Write the channel file, and say where it is.

    Raises
    ------
    ShipcosimError
        If there is a file already, or it cannot be written.
    """
    from shipcosim.cli.console import shown_path
    from shipcosim.series import write_file

    if out.exists() and not force:
        raise error_at(str(out), "There is such a file already.", "--force writes over it.")
    write_file(out, proposed.text.encode())
    say(f"Channel file: {shown_path(out)}")
