"""At night: diagnoses, replays, comparisons and calibrations as Python gives them back."""

import pytest

import shipcosim as sc


def test_a_calibration_is_what_a_diagnosis_takes(tmp_path):
    ship = sc.calibrate("gunnerus_log", out=tmp_path / "ship")
    assert "Calibration of gunnerus_open" in repr(ship) and "Moved most" in ship._repr_html_()
    assert (tmp_path / "ship" / "report.html").is_file()
    assert ship.page().html
