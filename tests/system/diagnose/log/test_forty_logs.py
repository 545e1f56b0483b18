"""Logs with an oddity each are read right without a channel file or with the proposed one: forty, and a stranger's."""

import pytest
from diagnose.log.oddities import CASES, SAID, THRUSTERS, truth
from diagnose.log.scoring import outcome
from diagnose.log.strange import STRANGE

from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of

READ_RIGHT = 0.95


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    table, found = truth(), {}
    for name, write in (CASES | STRANGE).items():
        folder = tmp_path_factory.mktemp(name)
        path = write(table, folder)
        found[name] = (*outcome(path, table, THRUSTERS, SAID.get(name, ())), path)
    return found


def test_nearly_all_are_read_right_and_none_is_read_wrong(outcomes):
    right = [name for name, (how, *_) in outcomes.items() if how in ("read", "proposed")]
    print(f"\n{len(right)} of {len(outcomes)} logs are read right")
    for name, (how, said, _) in outcomes.items():
        print(f"  {how:9} {name} {said if how not in ('read',) else ''}")
    assert len(CASES) >= 40
    assert not {name: said for name, (how, said, _) in outcomes.items() if how.startswith("wrong")}
    assert len(right) >= READ_RIGHT * len(outcomes)


def test_every_column_is_used_or_not_used_for_a_reason(outcomes):
    for *_, path in outcomes.values():
        log = columns_of(path)
        proposal = propose(log, THRUSTERS)
        used = {name for guess in proposal.used for name in guess.channel.columns}
        reasons = {guess.column: guess.why for guess in proposal.unused}
        assert used | set(reasons) == set(log.values), path
        assert all(reasons.values())
