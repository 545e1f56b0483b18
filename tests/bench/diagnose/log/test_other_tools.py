"""Logs by the conventions of other tools open with the right channels or are asked; none is wrong in silence.

`pytest -s tests/bench/diagnose/log/test_other_tools.py` prints how each opens.
"""

from collections import Counter

import pytest
from diagnose.log.other_tools import cells, logs, motion, outcome, written

RIGHT = 0.95
"""Share of logs that open, or do so once what is asked is confirmed."""


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    table = motion()
    rows = list(cells(table))
    folders = {name: tmp_path_factory.mktemp("log") for name in logs()}
    return {
        name: outcome(log, written(log, rows, folders[name]), table) for name, log in logs().items()
    }


def test_nearly_all_logs_of_other_tools_are_right_and_none_is_wrong(outcomes):
    for name, (how, said) in outcomes.items():
        print(f"  {how:12} {name}: {said[:200]}")
    counts = Counter(how for how, _ in outcomes.values())
    print(f"{len(outcomes)} logs: {dict(counts)}")
    assert counts["wrong"] + counts["wrong guess"] == 0
    assert counts["open"] + counts["asked"] >= RIGHT * len(outcomes)
