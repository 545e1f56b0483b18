"""The catalogue holds the contract's causes with sizes that make sense, and takes a user's own."""

import numpy as np
import pytest
from diagnose import twin
from ships import lend

from shipcosim.diagnose.experiment.testability import log_facts
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.hypotheses.cause import FACTS
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.errors import ShipcosimError
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.ssp import new

CONTRACT = {  # parameters and units by cause, ../shared/contracts.md
    "current": {"north": "m/s", "east": "m/s"},
    "current_varying": dict.fromkeys(("north_start", "east_start", "north_end", "east_end"), "m/s"),
    "wave_drift": {"north": "N", "east": "N"},
    "tow": {"north": "N", "east": "N"},
    "wind_scale": {"scale": "1"},
    "wind_direction": {"offset": "deg"},
    "thrust_loss": {"loss": "1"},
    "azimuth_offset": {"offset": "deg"},
    "thruster_position_x": {"x": "m"},
    "thruster_position_y": {"y": "m"},
    "azimuths_position_x": {"x": "m"},
    "rpm_offset": {"offset": "rpm"},
    "reverse_loss": {"loss": "1"},
    "thruster_interaction": {"loss": "1"},
    "mass": {"scale": "1"},
    "yaw_inertia": {"inertia": "kg.m2"},
    "drag": {"scale": "1"},
    "crossflow": {"scale": "1"},
    "heading_bias": {"offset": "deg"},
    "lever_arm": {"x": "m", "y": "m"},
    "velocity_scale": {"scale": "1"},
    "navigation_lag": {"lag": "s"},
    "thruster_lag": {"lag": "s"},
    "thrust_to_inertia": {"ratio": "1"},
}
SEA_TRIALS = {  # sought only where a ship manoeuvres at speed
    "hull_interaction": {"loss": "1"},
    "slow_azimuths": {"rate": "rad/s"},
    "azimuth_side_force": {"coefficient": "1"},
    "drag_over_speed": {"power": "1", "scale": "1"},
    "drift_drag": {"coefficient": "1"},
    "hull_lift": {"coefficient": "N.s2/m2"},
    "hull_lift_place": {"place": "m"},
    "late_orders": {"lag": "s"},
    "surge_added_mass": {"mass": "kg"},
    "sway_added_mass": {"mass": "kg"},
    "sway_momentum": {"coefficient": "1"},
    "turn_drag": {"coefficient": "1"},
    "yaw_damping": {"coefficient": "1"},
}
BY_COMPARISON = {name for name in CONTRACT if name.endswith("_to_inertia")}
"""Found by holding commanded against measured force, so no hypothesis of a fit."""
WHERE = {
    "thrust_loss": ["port", "starboard", "tunnel"],
    "azimuth_offset": ["port", "starboard"],
    "thruster_position_x": ["port", "starboard", "tunnel"],
    "thruster_position_y": ["port", "starboard"],
    "rpm_offset": ["port", "starboard", "tunnel"],
}
MINE = """
cause = "side_force"
sentence = "The unit's side force is larger or smaller than modelled"
reference = "-"
for_each = "azimuth"

[parameters.coefficient]
of = ["{thruster}.side_force_coefficient"]
typical = 0.5
relative_to = "{thruster}.side_force_coefficient"
bounds = [-1.0, 4.0]
"""


@pytest.fixture(scope="module")
def everyone():
    return hypotheses_of(read_catalogue(), twin.model())


@pytest.fixture(scope="module")
def at_sea_trials():
    return hypotheses_of(read_catalogue(), twin.model(), "sea trials")


def test_every_physical_cause_of_the_contract_is_there_with_its_parameters_and_units():
    found = {
        c: {n: p.unit for n, p in effect.parameters.items()}
        for c, effect in read_catalogue().items()
    }
    assert found == CONTRACT | SEA_TRIALS


def test_causes_of_sea_trials_are_only_sought_there(everyone, at_sea_trials):
    assert not {hypothesis.cause for hypothesis in everyone} & set(SEA_TRIALS)
    assert {hypothesis.cause for hypothesis in at_sea_trials} == (
        set(CONTRACT) | set(SEA_TRIALS)
    ) - BY_COMPARISON


def test_each_cause_sits_where_the_contract_says(everyone):
    found = {}
    for hypothesis in everyone:
        found.setdefault(hypothesis.cause, []).append(hypothesis.component)
    assert found == {cause: WHERE.get(cause, [None]) for cause in set(CONTRACT) - BY_COMPARISON}


def test_every_file_says_what_it_is_and_where_it_is_from():
    for effect in read_catalogue().values():
        assert (
            effect.sentence[0].isupper()
            and len(effect.sentence) > 20
            and len(effect.reference) > 10
        )


def test_bounds_hold_the_model_and_what_is_typical_is_above_what_matters_above_what_is_tolerated(
    at_sea_trials,
):
    for hypothesis in at_sea_trials:
        for parameter in hypothesis.parameters:
            low, high = sorted(parameter.bounds)
            assert low <= parameter.neutral <= high, hypothesis.label
            assert max(high - parameter.neutral, parameter.neutral - low) >= parameter.typical, (
                hypothesis.label
            )
            assert (
                parameter.typical
                > hypothesis.definition.least * parameter.typical
                >= 1.5 * parameter.tolerance
            ), hypothesis.label


def test_companions_are_numbers_of_the_ship_that_are_only_known_within_a_tolerance(everyone):
    for hypothesis in everyone:
        assert all(twin.model().tolerances[path] > 0.0 for path in hypothesis.definition.companions)
        assert all(twin.model().has(path) for path in hypothesis.definition.replaces)


def test_units_of_a_file_are_those_of_the_report_and_the_ships_numbers_are_in_hers(everyone):
    parameters = {hypothesis.label: hypothesis.parameters[0] for hypothesis in everyone}
    offset = parameters["heading_bias"]
    assert offset.typical == pytest.approx(np.radians(3.0)) and offset.factor == pytest.approx(
        180.0 / np.pi
    )
    assert parameters["rpm_offset of tunnel"].typical == pytest.approx(0.06 * 1780.0)
    assert parameters["rpm_offset of tunnel"].bounds == pytest.approx((-0.3 * 1780.0, 0.3 * 1780.0))
    assert parameters["tow"].typical == pytest.approx(0.004 * 531e3)
    assert parameters["mass"].factor == 1.0


def test_tolerances_are_those_of_the_parameter_sets_where_they_say(everyone):
    parameters = {hypothesis.label: hypothesis.parameters[0] for hypothesis in everyone}
    assert parameters["thrust_loss of port"].tolerance == 0.01
    assert parameters["heading_bias"].tolerance == pytest.approx(np.radians(0.1))


def test_reverse_loss_turns_both_units_at_once(everyone):
    (parameter,) = next(
        hypothesis for hypothesis in everyone if hypothesis.cause == "reverse_loss"
    ).parameters
    assert parameter.paths == ("port.reverse_loss", "starboard.reverse_loss")


def test_a_ship_without_a_thruster_has_no_causes_of_one(root):
    hull = new("barge")
    hull.add_component("ship", twin.build_stale(root) / "vessel.fmu", kinds=())
    lend(hull, "ship", HullParameters, WindParameters)
    found = {
        hypothesis.cause
        for hypothesis in hypotheses_of(read_catalogue(), ship_model_of(hull.checked()))
    }
    assert not found & {
        "thrust_loss",
        "azimuth_offset",
        "rpm_offset",
        "reverse_loss",
        "thruster_interaction",
    }
    assert {"current", "mass", "heading_bias"} <= found


def test_a_cause_of_ones_own_takes_one_file(tmp_path):
    (tmp_path / "side_force.toml").write_text(MINE, encoding="utf-8")
    (tmp_path / "notes.txt").write_text("not a cause", encoding="utf-8")
    catalogue = read_catalogue(tmp_path)
    assert set(catalogue) == {*CONTRACT, *SEA_TRIALS, "side_force"}
    mine = [
        hypothesis
        for hypothesis in hypotheses_of(catalogue, twin.model())
        if hypothesis.cause == "side_force"
    ]
    assert [hypothesis.label for hypothesis in mine] == [
        "side_force of port",
        "side_force of starboard",
    ]
    (parameter,) = mine[0].parameters
    assert (parameter.neutral, parameter.typical) == pytest.approx((0.8, 0.4))


def test_a_file_with_the_name_of_a_known_cause_replaces_it(tmp_path):
    mine = MINE.replace('"side_force"', '"mass"').replace('"azimuth"', '"ship"')
    mine = mine.replace("{thruster}.side_force_coefficient", "vessel.mass_scale")
    (tmp_path / "mass.toml").write_text(mine, encoding="utf-8")
    catalogue = read_catalogue(tmp_path)
    assert set(catalogue) == {*CONTRACT, *SEA_TRIALS} and list(catalogue["mass"].parameters) == [
        "coefficient"
    ]


@pytest.mark.parametrize("key", ["typical", "tolerance", "bounds", "least", "cost", "sign"])
@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e400", "true", '"0.5"'])
def test_a_number_of_a_cause_is_finite_and_no_other_value(tmp_path, key, value):
    lines = {
        "typical": MINE.replace("typical = 0.5", f"typical = {value}"),
        "tolerance": f"{MINE}tolerance = {value}\n",
        "bounds": MINE.replace("4.0]", f"{value}]"),
        "least": MINE.replace("for_each", f"least = {value}\nfor_each"),
        "cost": MINE.replace("for_each", f"cost = {value}\nfor_each"),
        "sign": f'{MINE}on_connections = {{ of = "rpm", sign = {value} }}\n',
    }
    (tmp_path / "one.toml").write_text(lines[key], encoding="utf-8")
    with pytest.raises(ShipcosimError, match=f"one.toml, .*{key}"):
        read_catalogue(tmp_path)


@pytest.mark.parametrize(
    ("is_there", "instead"),
    [
        ("typical = 0.5", "typical = 0.0"),
        ("typical = 0.5", "typical = 0.5\ntolerance = -0.1"),
        ("bounds = [-1.0, 4.0]", "bounds = [4.0, -1.0]"),
        ("typical = 0.5", 'typical = 0.5\nunit = "parsnip"'),
        ('of = ["{thruster}.side_force_coefficient"]', "of = []"),
    ],
)
def test_a_cause_that_no_log_can_show_is_refused(tmp_path, is_there, instead):
    (tmp_path / "one.toml").write_text(MINE.replace(is_there, instead), encoding="utf-8")
    with pytest.raises(ShipcosimError, match="one.toml, parameters.coefficient"):
        read_catalogue(tmp_path)


def test_two_files_of_a_folder_with_one_cause_are_refused(tmp_path):
    for name in ("one.toml", "two.toml"):
        (tmp_path / name).write_text(MINE, encoding="utf-8")
    with pytest.raises(ShipcosimError, match="two.toml: 'side_force' is the cause of another file"):
        read_catalogue(tmp_path)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('statement = "a side force of {size}"', "size"),
        ('next_step = "Inspect {coefficient}."', "coefficient"),
        ('why_not_testable = "the swell was {swell}"', "swell"),
        ('law = "turning"', "sought_by"),
        ('law = "vector"', "two parameters"),
    ],
)
def test_text_or_law_that_lacks_something_is_refused_with_what_it_lacks(tmp_path, line, said):
    (tmp_path / "one.toml").write_text(
        MINE.replace('reference = "-"', f'reference = "-"\n{line}'), encoding="utf-8"
    )
    with pytest.raises(ShipcosimError, match=said):
        read_catalogue(tmp_path)


def test_numbers_that_an_extension_or_a_search_names_are_numbers_of_the_ship():
    ship = set(twin.model().numbers)
    for cause in read_catalogue().values():
        assert set(cause.sought_by) <= ship
        assert cause.extension is None or set(cause.extension.parameters) <= ship


def test_facts_of_a_log_are_those_that_texts_can_have():
    assert set(log_facts(twin.problem("healthy"))) == set(FACTS)


def test_everything_wrong_in_a_folder_is_said_with_file_and_field(tmp_path):
    (tmp_path / "one.toml").write_text(
        MINE.replace("typical = 0.5", 'typical = "much"'), encoding="utf-8"
    )
    (tmp_path / "two.toml").write_text(MINE.replace("for_each", "foreach"), encoding="utf-8")
    (tmp_path / "three.toml").write_text("cause =", encoding="utf-8")
    with pytest.raises(ShipcosimError) as caught:
        read_catalogue(tmp_path)
    said = {problem.where.rpartition("/")[2]: str(problem) for problem in caught.value.problems}
    assert set(said) == {
        "one.toml, parameters.coefficient.typical",
        "two.toml, foreach",
        "three.toml",
    }
    assert all("add-a-cause.md" in text for text in said.values())
