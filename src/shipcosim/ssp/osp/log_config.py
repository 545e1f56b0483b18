"""Reader of LogConfig.xml, libcosim's settings of what to record."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from shipcosim.errors import error_at, raise_errors
from shipcosim.ssp.xml.document import AnyPath, Findings, local, parts_in, read_document


class LogConfig(NamedTuple):
    """Signals that libcosim would record.

    Attributes
    ----------
    signals : tuple of str
        ``simulator.variable``, or ``simulator.*`` where all of a simulator is recorded.
    steps : int
        Steps from one row to the next: the smallest decimation factor, as our table has one time for all signals.
    """

    signals: tuple[str, ...]
    steps: int


def read_log_config(path: AnyPath) -> LogConfig:
    """Read a LogConfig.xml.

    Raises
    ------
    ShipcosimError
        If it is none, with all that is wrong.
    """
    findings = Findings()
    document = read_document(Path(path), str(path), findings)
    raise_errors(findings.problems)
    assert document is not None
    if local(document.root) != "simulators":
        remedy = "Its root is <simulators>, with a <simulator> and its <variable>s for each that is recorded."
        raise error_at(str(path), "This is no LogConfig.xml.", remedy)

    signals = []
    steps = []
    for simulator in document.root:
        if local(simulator) != "simulator":
            continue
        name = simulator.get("name", "")
        variables = [variable.get("name", "") for variable in parts_in(simulator, "variable")]
        signals += [f"{name}.{variable}" for variable in variables or ["*"]]
        factor = simulator.get("decimationFactor", "1")
        if not factor.isascii() or not factor.isdecimal() or int(factor) < 1:
            raise error_at(
                f"{path}, line {simulator.sourceline}: {name}",
                f"decimationFactor = '{factor}' is no number of steps.",
                "Right would be a whole number from 1 on.",
            )
        steps.append(int(factor))
    return LogConfig(tuple(signals), min(steps, default=1))
