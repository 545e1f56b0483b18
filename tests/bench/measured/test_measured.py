"""At night: logs of real craft through the whole diagnosis: no crash, figures of the error, time and memory."""

import pytest
from measured.logs import FOLDERS, files
from measured.test_measured import (
    MEASURED,
    check_exchanged,
    diagnosed,
    fmus,
    has_figures,
    log,
)

from shipcosim.diagnose.joint_pipeline import diagnose_jointly
from shipcosim.ssp import read_system

HERE = [craft for craft in FOLDERS if (MEASURED / FOLDERS[craft]).is_dir()]


LOGS = [(craft, path.name) for craft in HERE for path in files(MEASURED.parent, craft)]


@pytest.mark.parametrize(("craft", "name"), LOGS)
def test_every_log_goes_through_the_whole_diagnosis(craft, name, log, fmus):
    found = diagnosed(*log(craft, name), fmus)
    assert has_figures(found)
    if craft == "kvlcc2":
        has_velocities_of_the_earth(found)


def test_of_a_short_log_of_a_spin_nothing_but_exchanged_thrusters_is_said(log, fmus):
    found = diagnosed(*log("blueboat", "run_228.csv.gz"), fmus)
    assert [finding.cause for finding in found.findings] == ["channel_swap"]


def has_velocities_of_the_earth(found):
    """HSVA's columns u and v are the rates of x and y to 1 mm/s; as those of the body they are off by 5 cm/s."""
    frames = [finding for finding in found.findings if finding.cause == "frame"]
    assert [set(finding.channels) for finding in frames] == [{"surge", "sway"}]
    assert "north and east" in frames[0].note


def test_logs_together_teach_a_craft_that_predicts_each_from_the_others(log, fmus):
    """Without this, three logs together gained nothing: 6.1 m after 10 s, and 6.3 m with their common ratio."""
    names = ("run_224.csv.gz", "run_230.csv.gz", "run_235.csv.gz")
    tables = [log("blueboat", name) for name in names]
    system = read_system(tables[0][2], fmus=[fmus])
    found = diagnose_jointly([table for table, *_ in tables], system, tables[0][1])
    gain = found.as_json()["gain"]
    assert gain["after_m"] < 0.55 * gain["before_m"] and found.craft.logs == 3


@pytest.mark.parametrize("name", ["run_218.csv.gz", "run_232.csv.gz"])
def test_thrusters_that_would_brake_the_craft_are_found_exchanged(name, log, fmus, tmp_path):
    check_exchanged(name, 2, log, fmus, tmp_path)
