"""Which causes a log could tell apart: on columns made by hand, and against what the diagnosis calls not testable."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnose import twin

from shipcosim.calls import logs
from shipcosim.cli.channel_files import print_isolability
from shipcosim.diagnose.experiment.isolability import Isolability, isolability
from shipcosim.diagnose.experiment.testability import Excitation, excitation_of, not_testable
from shipcosim.diagnose.pipeline import find_causes


def excitation(effects, known=()):
    """Excitation whose causes do this to the rows of a log, one column each, beside known numbers with their tolerance."""
    columns = [
        SimpleNamespace(prior=prior, changes={f"known {i}": 1.0})
        for i, (prior, _) in enumerate(known)
    ]
    columns += [SimpleNamespace(prior=1.0, changes={name: 1.0}) for name in effects]
    for column in columns:
        column.gives_way = lambda taken, column=column: bool(taken & set(column.changes))
    rows = np.column_stack([np.zeros(400), *(effect for _, effect in known), *effects.values()])
    causes = [
        SimpleNamespace(label=name, definition=SimpleNamespace(law="steady")) for name in effects
    ]
    groups = [(cause, [len(known) + i]) for i, cause in enumerate(causes)]
    return Excitation(rows.T @ rows, columns, groups)


def told(effects, known=()):
    return {one.label: one for one in isolability(excitation(effects, known))}


@pytest.mark.parametrize("seed", range(5))
def test_effects_of_one_shape_look_alike_and_others_do_not(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 400))
    found = told({"a": a, "twice a": 2.0 * a, "b": b, "nearly b": b + 0.05 * a, "small": 1e-3 * b})
    assert found["a"].similar == ("twice a",) and found["twice a"].similar == ("a",)
    # They differ by half of 0.05^2 times 400, less than 3 nats.
    assert "nearly b" in found["b"].similar and "b" in found["nearly b"].similar
    assert "a" not in found["b"].similar
    assert found["a"].gain == pytest.approx(0.5 * a @ a)
    assert not found["small"].is_seen and found["small"].similar == ()


def test_a_known_number_hides_what_has_its_shape_as_far_as_it_may_be_off():
    a, b = np.random.default_rng(1).normal(size=(2, 400))
    for tolerance in (0.01, 0.1, 1.0):
        found = told({"a": a, "b": b}, known=[(tolerance, a)])
        square = a @ a
        assert found["a"].gain == pytest.approx(0.5 * square / (1.0 + tolerance**2 * square))
        assert found["b"].is_seen


def test_what_is_not_seen_in_a_log_is_what_a_diagnosis_calls_not_testable():
    basis = find_causes(twin.logs()["current"], twin.system()).basis
    seen = excitation_of(basis)
    found = isolability(seen)
    assert len({one.label for one in found}) == len(found)
    unseen = {one.label.partition(" of ")[0] for one in found if not one.is_seen}
    assert {one for one in not_testable(seen) if one != "current_varying"} <= unseen


def test_the_command_prints_a_row_a_cause(monkeypatch, capsys):
    rows = Isolability("tow", 90.0, True, ("current",)), Isolability("drag", 0.1, False, ())
    monkeypatch.setattr(logs, "isolability", lambda *_: rows)
    print_isolability("log.csv", None, None)
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split() == ["tow", "yes", "current"]
    assert lines[2].split() == ["drag", "no", "-"]
