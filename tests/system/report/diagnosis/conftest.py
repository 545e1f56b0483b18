"""A diagnosis to show, from a log of the independent truth."""

import pytest

from shipcosim.diagnose.extension.extended_system import ExtendedSystem
from shipcosim.diagnose.pipeline import find_causes
from shipcosim.diagnose.statement import completed
from shipcosim.diagnose.validation.conditions import PredictedLog
from shipcosim.diagnose.validation.gain import compare
from shipcosim.diagnose.validation.missing_force import missing_forces
from shipcosim.diagnose.validation.replays import SimulatedLog
from shipcosim.library import build_stale
from shipcosim.ssp import read_system
from truth import draw


@pytest.fixture(scope="session")
def predicted(root, tmp_path_factory):
    """A thruster that has lost a third of its thrust, from a log of the independent truth: findings and predictions."""
    path = tmp_path_factory.mktemp("log") / "lossy.csv"
    draw("trial", 3000, among=["thrust_loss"], minutes=12).save(path)
    found = find_causes(path, read_system(root / "ssp" / "gunnerus_open", fmus=[build_stale(root)]))
    problem, fit = found.basis.problem, found.basis.fit
    return found, PredictedLog(
        found.basis, True, compare(problem, fit), {}, missing_forces(problem, fit)
    )


@pytest.fixture(scope="session")
def diagnosis(root, predicted):
    """The same with all that the page shows, in array form, the system not extended."""
    found, log = predicted
    system = ExtendedSystem(
        read_system(root / "ssp" / "gunnerus_open", fmus=[build_stale(root)]), ""
    )
    return completed(found, log, system, SimulatedLog(log.comparison.errors, {}, False))
