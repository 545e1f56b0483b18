"""No cause is a sure candidate of an unknown, nor both a candidate and not testable: on craft, trial and real logs."""

from pathlib import Path

import pytest
from craft import draw as draw_craft
from diagnose import twin
from measured.logs import CHANNELS, FOLDERS, as_table, files

from shipcosim.diagnose.checked_log import ReadLog
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.pipeline import find_causes, problem_of, verdict_on
from shipcosim.diagnose.statement import stated
from shipcosim.library import build_stale
from shipcosim.ssp import read_system
from truth import draw

ROOT = Path(__file__).resolve().parents[3]
MEASURED = ROOT.parent / "shared" / "measured"
SURE = 0.99
REAL = [(c, p) for c in FOLDERS if (MEASURED / FOLDERS[c]).is_dir() for p in files(MEASURED.parent, c)]
CRAFT = [(201, "none", "damping"), (203, "exchanged", "none"), (205, "none", "one weak")]


def agrees(found):
    """What is said of causes does not contradict itself."""
    candidates = {one.cause: one.probability for one in (*found.candidates, *found.indistinguishable)}
    said = {*candidates, *(finding.cause for finding in found.findings)}
    assert not said & {*found.not_testable}, found.verdict
    assert found.verdict != "unknown" or all(chance < SURE for chance in candidates.values()), candidates


def of_craft(seed, fault, change):
    drawn = draw_craft(seed, fault=fault, change=change)
    return stated(verdict_on(problem_of(ReadLog(read_log(drawn.log), drawn.model, read_catalogue())), lambda *_: None))


def test_candidates_of_a_drawn_craft_do_not_contradict_what_is_not_testable():
    found = of_craft(228, "exchanged", "none")
    agrees(found)
    assert {"channel_swap", "sign"} <= {*found.not_testable}


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "fault", "change"), CRAFT)
def test_candidates_of_drawn_craft(seed, fault, change):
    agrees(of_craft(seed, fault, change))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [704, 705, 706])
@pytest.mark.parametrize("kind", ["trial", "hold"])
def test_candidates_of_trial_logs_with_something_that_no_cause_explains(seed, kind, tmp_path):
    draw(kind, seed, causes="unknown").save(tmp_path / "log.csv")
    agrees(find_causes(tmp_path / "log.csv", twin.system()))


@pytest.mark.slow
@pytest.mark.skipif(not REAL, reason="needs the logs in ../shared/measured, which are not here")
@pytest.mark.parametrize(("craft", "path"), REAL)
def test_candidates_of_measured_logs(craft, path, tmp_path):
    system = read_system(ROOT / "ssp" / f"{craft}_open", fmus=[build_stale(ROOT)])
    agrees(find_causes(as_table(path, tmp_path), system, channels=CHANNELS / f"{craft}.toml"))
