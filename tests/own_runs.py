"""Runs of ships of one's own, without sensors, as logs."""

from pathlib import Path

from typer.testing import CliRunner

import shipcosim as sc
from shipcosim.cli.app import app

_CHANGES = """
[[events]]
time = 300.0
override = { "reference.x_set" = 10.0, "reference.y_set" = 5.0 }

[[events]]
time = 600.0
override = { "reference.x_set" = 0.0, "reference.psi_set" = "40 deg" }
"""


def own_run(project: Path, propulsion: str, sizes: list[str], minutes: float = 15.0) -> sc.Run:
    """A run under DP of a new ship of a project, which goes to another place after 5 min and 10 min."""
    (project / "scenarios").mkdir()
    asked = ["new", "ship", "tern", *sizes, "--propulsion", propulsion, "--yes"]
    made = CliRunner().invoke(app, asked)
    assert made.exit_code == 0, made.output
    scenario = project / "scenarios" / "tern.toml"
    with scenario.open("a", encoding="utf-8") as file:
        file.write(_CHANGES)
    return sc.run("tern", stop_time=60.0 * minutes, out="run")
