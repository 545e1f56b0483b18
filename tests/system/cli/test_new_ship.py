"""`shipcosim new ship`: from a few particulars, or a ship file, to systems and a scenario that run."""

import pytest
from typer.testing import CliRunner

import shipcosim as sc
from shipcosim.capability.result import LEVEL_1
from shipcosim.cli.app import app
from shipcosim.ships.described import describe, file_from
from shipcosim.ships.writing import Answers, ship_text

ASKED = ["--length", "60 m", "--breadth", "14 m", "--draught", "4.5 m"]


@pytest.fixture
def project(tmp_path, monkeypatch):
    (tmp_path / "scenarios").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def told(*arguments):
    # Wide enough for the sources of the numbers.
    return CliRunner().invoke(app, [*arguments], env={"COLUMNS": "120"})


def test_a_few_options_make_a_ship_that_is_found_checked_and_runs(project):
    made = told("new", "ship", "tern", *ASKED, "--yes")
    assert made.exit_code == 0, made.output
    for name in ("ships/tern/ship.toml", "ssp/tern_open", "ssp/tern_dp", "scenarios/tern.toml"):
        assert (project / name).exists() and name in made.stdout
    checked = told(
        "check", "ships/tern/ship.toml", "scenarios/tern.toml", "ssp/tern_open", "ssp/tern_dp"
    )
    assert checked.exit_code == 0, checked.output
    assert "vessel.A22" in checked.stdout and "Clarke" in checked.stdout
    assert (
        'origin = "assumed: usual of a ship of this size"'
        in (project / "ships/tern/ship.toml").read_text()
    )
    ran = told("run", "tern", "--until", "2")
    assert "Traceback" not in ran.output and (project / "results/tern").is_dir(), ran.output


@pytest.mark.parametrize("wrong", ["-60", "0", "-0.0", "nan", "4 degC"])
@pytest.mark.parametrize(
    "option", ["--length", "--breadth", "--draught", "--displacement", "--speed", "--power"]
)
def test_a_size_that_no_ship_has_is_refused_by_name(project, option, wrong):
    given = dict(zip(ASKED[::2], ASKED[1::2], strict=True)) | {option: wrong}
    made = told("new", "ship", "tern", *(part for pair in given.items() for part in pair), "--yes")
    assert made.exit_code == 2 and not (project / "ships").exists()
    assert "fault of shipcosim" not in made.output and "domain" not in made.output
    assert ("greater than 0" in made.output) == (wrong in ("-60", "0", "-0.0"))


@pytest.mark.parametrize("wrong", ["1e-9 m", "4.5 mm", "0.09 m", "1001 m", "2 nmi"])
@pytest.mark.parametrize("option", ["--length", "--breadth", "--draught"])
def test_a_dimension_in_a_wrong_unit_is_refused_by_name(project, option, wrong):
    given = dict(zip(ASKED[::2], ASKED[1::2], strict=True)) | {option: wrong}
    made = told("new", "ship", "tern", *(part for pair in given.items() for part in pair), "--yes")
    assert made.exit_code == 2 and not (project / "ships").exists()
    assert f"{option[2:]} = {wrong}. Ships have 0.1 to 1000 m" in " ".join(made.output.split())
    assert "power" not in made.output


def test_nothing_is_written_over_without_being_told(project):
    assert told("new", "ship", "tern", *ASKED, "--propulsion", "rudder", "--yes").exit_code == 0
    before = (project / "ships/tern/ship.toml").read_bytes()
    again = told("new", "ship", "tern", *ASKED, "--propulsion", "screws", "--yes")
    assert again.exit_code == 2 and "there already" in again.output
    assert (project / "ships/tern/ship.toml").read_bytes() == before and not (
        project / "ssp/tern_dp"
    ).exists()
    assert (
        told("new", "ship", "tern", *ASKED, "--propulsion", "screws", "--yes", "--force").exit_code
        == 0
    )
    assert (project / "ssp/tern_dp").is_dir()


def test_a_changed_ship_file_makes_the_systems_again(project):
    assert told("new", "ship", "tern", *ASKED, "--propulsion", "rudder", "--yes").exit_code == 0
    file = project / "ships/tern/ship.toml"
    file.write_text(file.read_text().replace('"60 m"', '"62 m"'))
    assert told("new", "ship", "tern", "--from", "ships/tern/ship.toml").exit_code == 0
    assert 'value="62.0"' in (project / "ssp/tern_open/resources/tern.ssv").read_text()


def test_a_ship_that_is_shipped_is_taken_with_her_tables(project):
    made = told("new", "ship", "mine", "--from", "otter")
    assert made.exit_code == 0, made.output
    assert (project / "ships/mine/wind.csv").is_file() and (project / "ssp/mine_open").is_dir()
    assert told("check", "ships/mine").exit_code == 0


def test_thrusters_are_told_one_by_one(project):
    bow = "name=bow, kind=tunnel, x=24 m, diameter=1.5 m, power=300 kW"
    aft = "name=pod, kind=azimuth, x=-27 m, y=0 m, diameter=2.4 m, power=1 MW"
    made = told("new", "ship", "tern", *ASKED, "--thruster", bow, "--thruster", aft, "--yes")
    assert made.exit_code == 0 and (project / "ssp/tern_dp").is_dir(), made.output
    stiff = told("new", "ship", "gull", *ASKED, "--thruster", bow, "--yes")
    assert stiff.exit_code == 0 and "no DP system" in stiff.output, stiff.output
    assert (project / "ssp/gull_open").is_dir() and not (project / "ssp/gull_dp").exists()
    # What she cannot do is a remark, what she can is none.
    assert "no steering trials" in stiff.output and not (project / "ssp/gull_trials").exists()
    assert "no steering trials" not in made.output and (project / "ssp/tern_trials").is_dir()


def test_a_thruster_comes_in_addition_to_the_propulsion_that_is_given(project):
    bow = "name=bow, kind=tunnel, x=24 m, diameter=1.5 m, power=300 kW"
    asked = [*ASKED, "--power", "2400 kW", "--thruster", bow, "--yes"]
    assert told("new", "ship", "tern", *asked, "--propulsion", "rudder").exit_code == 0
    text = (project / "ships/tern/ship.toml").read_text()
    assert 'kind = "rudder"' in text and 'kind = "tunnel"' in text
    # What was given is neither lost nor marked as assumed.
    assert 'power = "2400 kW"' in text and 'power = "300 kW"' in text
    half = (project / "scenarios/tern.toml").read_text().partition('"propeller_rpm" = ')[2]
    assert float(half.partition("\n")[0]) != 50.0  # of the propeller's own power
    made = told("new", "ship", "gull", *asked, "--propulsion", "azimuths")
    text = (project / "ships/gull/ship.toml").read_text()
    assert made.exit_code == 0 and text.count('name = "bow"') == 1 and 'x = "24 m"' in text
    assert text.count('power = "1200 kW"') == 2


def test_a_propeller_with_a_rudder_is_not_left_out_of_a_capability_silently(project):
    bow = "name=bow, kind=tunnel, x=24 m, diameter=1.5 m, power=300 kW"
    asked = [*ASKED, "--propulsion", "rudder", "--thruster", bow, "--yes"]
    assert told("new", "ship", "tern", *asked).exit_code == 0
    refused = told("capability", "tern_open")
    assert refused.exit_code == 2 and "propeller: a propeller with a rudder" in refused.output


def test_kinds_of_ship_are_all_listed_and_those_with_a_comma_are_quoted(project):
    made = told("new", "ship", "tern", *ASKED, "--kind", "tug", "--yes")
    assert made.exit_code == 2
    listed = made.output.partition("There is: ")[2]
    assert "'cargo ship, loaded'" in listed and "tender" in listed and "in all" not in listed


def test_what_comes_next_stands_in_one_column(project):
    made = told("new", "ship", "tern", *ASKED, "--yes").stdout
    lines = made.partition("Go on with:\n")[2].splitlines()
    assert len(lines) == 6 and len({line.rindex("   ") for line in lines}) == 1


@pytest.mark.parametrize("propulsion", ["azimuths", "screws"])
def test_a_new_ship_has_a_capability_and_a_study_of_failures(project, propulsion):
    assert told("new", "ship", "tern", *ASKED, "--propulsion", propulsion, "--yes").exit_code == 0
    assert told("check", "studies/tern_failures.toml").exit_code == 0
    numbers = sc.capability("tern_dp", failures=[("port", "starboard")]).numbers(LEVEL_1)
    intact, lost = numbers[0], numbers[-1]
    assert intact.min() >= 1 and intact[0] >= 4  # from ahead the propellers push
    assert (lost <= intact).all() and lost[0] == 0


def test_a_new_ship_with_a_rudder_sails_a_turning_circle(project):
    assert told("new", "ship", "gull", *ASKED, "--propulsion", "rudder", "--yes").exit_code == 0
    assert told("check", "scenarios/gull_zig_zag.toml").exit_code == 0
    circle = told("run", "gull_circle")
    assert circle.exit_code == 0 and "trial.tactical_diameter" in circle.stdout, circle.output


def test_a_file_beside_the_ship_file_replaces_an_estimate_of_the_capability(project):
    assert told("new", "ship", "tern", *ASKED, "--yes").exit_code == 0
    before = sc.capability("tern_dp")
    (project / "ships/tern/capability.toml").write_text(
        'wind_area_side = { value = 2000.0, unit = "m2", origin = "drawing" }'
    )
    after = sc.capability("tern_dp")
    assert after.vessel.hull.wind_area_side == 2000.0
    assert after.vessel.hull.bow_angle == before.vessel.hull.bow_angle
    assert (after.numbers(LEVEL_1)[0] <= before.numbers(LEVEL_1)[0]).all()


@pytest.mark.parametrize(("length", "breadth"), [("24 m", "8 m"), ("82 m", "20 m")])
def test_numbers_in_the_comments_are_those_that_are_estimated(length, breadth, tmp_path):
    answers = Answers(length=length, breadth=breadth, draught="3 m")
    text = ship_text(answers)
    given = "\n".join(
        line.removeprefix("# ") if " = " in line and line.startswith("# ") else line
        for line in text.splitlines()
        if "{{" not in line and "Where one comes" not in line and "well it is known" not in line
    )
    estimated, written = (
        describe(tmp_path / "ship.toml", file_from(one, tmp_path / "ship.toml"))
        for one in (text, given)
    )
    assert written.file.wind.side_area is not None and estimated.file.wind.side_area is None
    assert written.file.wind.side_area.value == pytest.approx(
        0.18 * written.form.length**2, rel=0.01
    )
    for name in ("mass", "inertia_yaw", "X_uu", "cross_flow_drag"):
        value = written.vessel[name].value
        assert value == pytest.approx(estimated.vessel[name].value, rel=0.02), name


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (["tern", "--yes"], "nothing says length, breadth, draught"),
        (["tern", *ASKED, "--propulsion", "sails", "--yes"], "'sails'"),
        (["tern", *ASKED, "--displacement", "1 kg", "--yes"], "1 kg do not fit"),
        (["tern", *ASKED, "--length", "sixty", "--yes"], "'sixty'"),
        (["tern", *ASKED, "--thruster", "bow", "--yes"], "found 'bow'"),
        (["../tern", *ASKED, "--yes"], "letters, digits"),
        (["tern", "--from", "nowhere.toml"], "nowhere"),
    ],
)
def test_what_is_wrong_is_said_and_nothing_is_written(arguments, found, project):
    made = told("new", "ship", *arguments)
    assert made.exit_code == 2 and found in made.output, made.output
    assert (
        "fault of shipcosim" not in made.output
        and not (project / "ssp").exists()
        and not (project / "ships").exists()
    )


def test_in_a_terminal_it_asks_for_what_is_not_said_and_proposes_what_is_usual(
    project, monkeypatch
):
    monkeypatch.setattr("shipcosim.cli.new_ship._is_terminal", lambda: True)
    answers = ["a ferry", "screws", "sixty", "40 m", "", "2.9 m", "", "11 kn", ""]
    made = CliRunner().invoke(app, ["new", "ship", "tern"], input="\n".join(answers) + "\n")
    assert made.exit_code == 0, made.output
    assert "'sixty'" in made.output and "Breadth [11 m]" in made.output
    text = (project / "ships/tern/ship.toml").read_text()
    assert (
        'description = "a ferry"' in text
        and 'length = "40 m"' in text
        and 'draught = "2.9 m"' in text
    )
    assert (
        'breadth = { value = "11 m", origin = "assumed' in text
        and text.count('kind = "tunnel"') == 2
    )


@pytest.mark.parametrize("propulsion", ["azimuths", "screws"])
def test_each_thruster_fails_and_allocator_and_consequence_analysis_are_told(project, propulsion):
    made = told("new", "ship", "tern", *ASKED, "--propulsion", propulsion, "--yes")
    assert made.exit_code == 0, made.output
    wires = sc.read("tern_dp").connections
    units = ["port", "starboard", "bow"] + ["stern"] * (propulsion == "screws")
    scenario = (project / "scenarios" / "tern.toml").read_text(encoding="utf-8")
    for number, unit in enumerate(units, 1):
        assert f'"{unit}.failed" = true' in (project / "studies/tern_failures.toml").read_text()
        event = f'[[events]]\ntime = 1.0\noverride = {{ "{unit}.failed" = true }}\n'
        (project / "scenarios" / "lost.toml").write_text(f"{scenario}\n{event}", encoding="utf-8")
        run = sc.run("lost", stop_time=20.0, out=f"lost-{unit}")
        # A shaft runs down as 1/(1 + t/T)²: a few percent are left after 19 s.
        thrust = abs(run[f"{unit}.thrust"])
        assert thrust[-1] <= 0.1 * thrust.max()
        assert run[f"allocator.thrust_cmd_{number}"][-1] == 0.0
        assert not run[f"{unit}.available"][-1]
        for asked in ("allocator", "consequences"):
            assert (f"{unit}.available", f"{asked}.available_{number}") in wires
