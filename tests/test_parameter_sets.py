"""The SSV files of R/V Gunnerus are what ssp/write_parameter_sets.py writes from the numbers in the models."""

import importlib.util

import pytest

from shipcosim.models.ships import SHIPS
from shipcosim.ssp import check_file, write_ssv


@pytest.fixture(scope="session")
def writer(root):
    spec = importlib.util.spec_from_file_location("write_parameter_sets", root / "ssp" / "write_parameter_sets.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("system", ["gunnerus_dp", "gunnerus_open"])
@pytest.mark.parametrize("ship", SHIPS)
def test_parameter_file_holds_the_numbers_of_the_models(system, ship, writer, root, tmp_path):
    write_ssv(tmp_path / "again.ssv", ship, writer.values(ship, writer.SYSTEMS[system]))
    committed = root / "ssp" / system / "resources" / f"{ship}.ssv"
    assert committed.read_bytes() == (tmp_path / "again.ssv").read_bytes()
    assert not [problem for problem in check_file(committed) if problem.severity == "error"]


def test_every_number_has_a_unit_or_is_a_pure_one_and_says_its_origin(writer):
    for ship in SHIPS:
        for value in writer.values(ship, writer.SYSTEMS["gunnerus_dp"]):
            description, _, origin = value.description.partition("; ")
            assert description and origin, value.name
