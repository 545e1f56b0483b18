"""At night: no cause is a sure candidate of an unknown, nor both a candidate and not testable."""

from pathlib import Path

import pytest
from diagnose import twin
from diagnose.test_candidates import agrees, of_craft
from measured.logs import CHANNELS, FOLDERS, as_table, files

from shipcosim.diagnose.pipeline import find_causes
from shipcosim.library import build_stale
from shipcosim.ssp import read_system
from truth import draw

ROOT = Path(__file__).resolve().parents[3]


MEASURED = ROOT.parent / "shared" / "measured"


REAL = [
    (c, p) for c in FOLDERS if (MEASURED / FOLDERS[c]).is_dir() for p in files(MEASURED.parent, c)
]


CRAFT = [(201, "none", "damping"), (203, "exchanged", "none"), (205, "none", "one weak")]


@pytest.mark.parametrize(("seed", "fault", "change"), CRAFT)
def test_candidates_of_drawn_craft(seed, fault, change):
    agrees(of_craft(seed, fault, change))


@pytest.mark.parametrize("seed", [704, 705, 706])
@pytest.mark.parametrize("kind", ["trial", "hold"])
def test_candidates_of_trial_logs_with_something_that_no_cause_explains(seed, kind, tmp_path):
    draw(kind, seed, causes="unknown").save(tmp_path / "log.csv")
    agrees(find_causes(tmp_path / "log.csv", twin.system()))


@pytest.mark.skipif(not REAL, reason="needs the logs in ../shared/measured, which are not here")
@pytest.mark.parametrize(("craft", "path"), REAL)
def test_candidates_of_measured_logs(craft, path, tmp_path):
    system = read_system(ROOT / "ssp" / f"{craft}_open", fmus=[build_stale(ROOT)])
    agrees(find_causes(as_table(path, tmp_path), system, channels=CHANNELS / f"{craft}.toml"))
