"""A craft whose thrust and damping are not her file's is learned from her log, and predicts what was held out."""

from functools import cache

import numpy as np
import pytest
from diagnose import twin, usv

from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.compared_log import compared, with_learned_craft
from shipcosim.diagnose.craft.learn import learn
from shipcosim.diagnose.craft.logged import craft_log
from shipcosim.diagnose.craft.numbers import numbers_of
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.ship.inputs import record_of
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.ssp import read_system

OTHER = {
    "left.thrust_loss": 0.35,
    "right.thrust_loss": 0.35,
    "hull.X_u": 0.0,
    "hull.X_uu": -45.0,
    "hull.N_r": -800.0,
}


@cache
def ship():
    return ship_model_of(usv.structure().checked())


@cache
def compared_log(seed, is_other=True):
    """A log of the craft as in `OTHER`, or of the file's, held against the file's."""
    sailed = usv.log(8.0, seed, usv.structure("other", **OTHER) if is_other else usv.structure())
    return compared(checked(ReadLog(read_log(sailed), ship(), read_catalogue())))


def to_learn(seed, part, is_other=True):
    """A log as a part of several that a craft is learned from."""
    found = compared_log(seed, is_other)
    record = record_of(found.repaired, ship())
    return craft_log(record, ship(), found.comparison.errors["horizon_s"], part, whole=True)


@cache
def learned(seed, is_other=True):
    found = compared_log(seed, is_other)
    return with_learned_craft(found.comparison, found.repaired, found.comparison.given(found.ship))


def test_thrust_and_damping_that_are_not_the_files_are_learned_from_one_log():
    craft = learned(21).craft
    assert craft.errors.after < 0.4 * craft.errors.before
    ship_now = craft.on(ship())
    thrust = 1.0 - ship_now.get("left.thrust_loss")
    assert thrust == pytest.approx(0.65, rel=0.1)
    # Resistance at 2 m/s, and the moment against a turn of 0.2 rad/s, as the craft has them.
    resistance = 2.0 * ship_now.get("hull.X_u") + 4.0 * ship_now.get("hull.X_uu")
    assert resistance == pytest.approx(-180.0, rel=0.15)


def test_what_one_log_teaches_predicts_another():
    craft = learned(21).craft
    other = to_learn(22, 0)
    numbers = [one.number for one in craft.numbers]

    def error(values):
        spread = np.array(values)[:, None, None] + np.zeros((1, 1, other.rows.size))
        return np.sqrt((other.missed(numbers, spread)[0, :2, -1] ** 2).sum(0).mean())

    before = error([one.given for one in numbers])
    assert error([one.value for one in craft.numbers]) < 0.4 * before


def test_several_logs_are_held_out_one_by_one():
    craft = learn([to_learn(seed, part) for part, seed in enumerate((21, 22, 23))])
    assert craft.logs == 3 and craft.errors.after < 0.35 * craft.errors.before


def test_of_a_craft_as_her_file_has_her_nothing_that_matters_is_learned():
    craft = learned(11, is_other=False).craft
    assert craft is None or craft.errors.after > 0.7 * craft.errors.before


def test_the_water_takes_energy_and_inertia_stays_positive():
    log = to_learn(21, 0)
    numbers = numbers_of(log.model, log.typical())
    assert all(one.sign == -1 for one in numbers if one.name.startswith("damping"))
    ship_now = learned(21).craft.on(ship())
    assert np.linalg.eigvalsh(ship_now.mass_matrix).min() > 0.0
    assert all(ship_now.get(f"hull.{name}") <= 0.0 for name in ("X_u", "X_uu", "Y_v", "N_r"))


def test_numbers_are_said_in_words_with_what_they_gain():
    craft = learned(21).craft
    text = str(craft.numbers[0])
    assert text.startswith("thrust 0.6") and "of the file's; without it the error is" in text
    entry = craft.as_json()
    assert entry["held_out"]["after"] < entry["held_out"]["before"]
    assert entry["numbers"][0]["error_without"] > 1.0


def test_the_extended_system_has_the_learned_numbers(tmp_path):
    craft = learned(21).craft
    made = extend(usv.structure(), [], tmp_path, craft)
    assert made.values == pytest.approx(craft.after)
    assert "craft, as learned beside the others of this set; from a log" in made.ssv.read_text()
    read = ship_model_of(read_system(str(made.ssp), fmus=[twin.build_stale(twin.ROOT)]))
    assert {path: read.get(path) for path in craft.after} == pytest.approx(craft.after)
