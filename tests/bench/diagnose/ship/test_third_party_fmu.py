"""At night: third-party thrusters: their surrogates are made by co-simulation, and what is wrong with them is named."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest
from diagnose import boat, twin
from diagnose.ship.test_third_party_fmu import logged, strange_azimuths

import shipcosim as sc
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.pipeline import find_causes
from shipcosim.series import write_table


@pytest.mark.parametrize("name", ["thrust_loss", "azimuth_offset"])
def test_our_azimuth_as_a_black_box_gets_the_same_diagnosis(name, strange_azimuths, tmp_path):
    write_table(twin.logs()[name], tmp_path / "log.csv")
    diagnosis = find_causes(tmp_path / "log.csv", twin.system())
    assert diagnosis.basis.problem.model.third_party
    (finding,) = diagnosis.findings
    (path, truth), *_ = twin.PLANTED[name].items()
    assert f"{finding.component}.{finding.cause}" == path
    truth = np.degrees(truth) if name == "azimuth_offset" else truth
    (estimate,) = finding.parameters.values()
    assert abs(estimate.estimate - truth) < 2.0 * estimate.std


@cache
def diagnosed(**factors):
    path = Path(mkdtemp(prefix="shipcosim-")) / "log.csv"
    write_table(logged(20.0, 0, **factors), path)
    return find_causes(path, boat.structure().checked())


def test_the_boats_weak_propeller_is_named_with_its_loss():
    diagnosis = diagnosed(left=0.75)
    (finding,) = diagnosis.findings
    loss = finding.parameters["loss"]
    assert (diagnosis.verdict, finding.label) == ("named", "thrust_loss of left")
    assert abs(loss.estimate - 0.25) < 2.0 * loss.std


def test_the_healthy_boat_is_consistent():
    assert diagnosed().verdict == "consistent"


def test_swapped_propellers_are_a_fault_of_the_log(tmp_path):
    log = logged(20.0)
    log = log.assign(left_rpm=log.right_rpm, right_rpm=log.left_rpm)
    write_table(log, tmp_path / "log.csv")
    diagnosis = find_causes(tmp_path / "log.csv", boat.structure().checked())
    (finding,) = diagnosis.findings
    assert (finding.cause, finding.channels) == ("channel_swap", ("left_rpm", "right_rpm"))


def test_the_extended_boat_replays_with_less_error(tmp_path):
    from shipcosim.diagnose.validation.cosimulation import Replayed, simulated
    from shipcosim.diagnose.validation.gain import compare

    diagnosis = diagnosed(left=0.75)
    extension = extend(boat.structure(), diagnosis.findings, tmp_path)
    extended = Replayed(sc.read(extension.ssp).checked(), extension.signals)
    errors = simulated(
        compare(diagnosis.basis.problem, diagnosis.basis.fit),
        Replayed(boat.structure().checked()),
        extended,
    )
    rms = np.sqrt((errors["position"].sel(horizon=60.0) ** 2).mean("segment"))
    assert rms.sel(model="extended") < 0.25 * rms.sel(model="plain")
    assert errors["difference"].sel(replayed="plain", horizon=60.0).mean() < 0.2
