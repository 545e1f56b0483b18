"""`shipcosim export fmu` leaves one FMU that any tool runs, or nothing."""

import shipcosim as sc
from shipcosim.ssp import read_fmu


def test_the_small_system_becomes_one_fmu(call, project):
    result = call("export", "fmu", "ssp/tank", "--out", "blocks", "--step-size", "0.1")
    assert result.code == 0 and result.out.strip() == "blocks/tank.fmu"
    fmu = read_fmu(project / "blocks" / "tank.fmu")
    assert set(fmu.variables) == {
        "time",
        "level_set",
        "lag.y",
        "lag.time_constant",
        "lag.fails_at",
        "lag.pause",
    }
    assert fmu.variables["level_set"].start == 1.0 and fmu.experiment["stepSize"] == 0.1


def test_connectors_alone_and_parameters_of_a_set(call, project):
    assert (
        call(
            "export", "fmu", "ssp/tank", "--connectors-only", "--unchecked", "--step-size", "0.1"
        ).code
        == 0
    )
    assert set(read_fmu(project / "tank.fmu").variables) == {"time", "level_set"}


def test_what_cannot_be_expressed_is_said_and_nothing_is_left(call, project):
    call("build")
    system = sc.read(project / "ssp" / "tank")
    system.add_component("two", project / "build" / "fmus" / "lag.fmu")
    system.connect("lag.y", "two.u", factor=2.0)
    system.write(project / "two.ssp")
    result = call("export", "fmu", "two.ssp", "--step-size", "0.1")
    assert (
        result.code == 2
        and "lag.y -> two.u:\nthe value is multiplied by 2 and 0 added" in result.err
    )
    assert not list(project.glob("*.fmu"))


def test_a_step_size_is_needed(call, project):
    result = call("export", "fmu", "ssp/tank")
    assert result.code == 2 and "--step-size" in result.err


def test_an_earlier_fmu_stays_where_none_can_be_made_and_is_kept_beside_a_new_one(call, project):
    (project / "tank.fmu").write_bytes(b"earlier")
    call("build")
    system = sc.read(project / "ssp" / "tank")
    system.add_component("two", project / "build" / "fmus" / "lag.fmu")
    system.connect("lag.y", "two.u", factor=2.0)
    system.write(project / "two.ssp")
    words = ["export", "fmu", "--unchecked", "--step-size", "0.1"]
    assert call(*words, "two.ssp").code == 2
    assert (project / "tank.fmu").read_bytes() == b"earlier"
    assert call(*words, "ssp/tank").code == 0
    assert (project / "tank-1.fmu").read_bytes() == b"earlier"
    assert read_fmu(project / "tank.fmu").variables
