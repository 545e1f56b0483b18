"""A predictor knows what the ship knows: none of its inputs is a truth of the simulation."""

from xml.etree import ElementTree

SSP = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"
ABOARD = {"dp_controller", "allocator", "sensors", "reference"}
"""FMUs whose outputs a ship has: what she measures, estimates and commands. Thrusters, vessel and weather are not."""


def sources_of_predictors(structure):
    """Connections into predictors: the FMU and the connector that each comes from."""
    root = ElementTree.parse(structure).getroot()
    fmus = {one.get("name"): one.get("source").rpartition("/")[2] for one in root.iter(f"{SSP}Component")}
    return [
        (fmus.get(line.get("startElement"), "").removesuffix(".fmu"), line.get("startConnector"))
        for line in root.iter(f"{SSP}Connection")
        if fmus.get(line.get("endElement"), "").endswith("predictor.fmu")
    ]


def test_no_input_of_a_predictor_is_a_truth_of_the_simulation(root):
    """Of the DP ship all inputs are connected, each to something aboard; no other system may do otherwise."""
    systems = {path.parent.name: sources_of_predictors(path) for path in (root / "ssp").glob("*/*.ssd")}
    truths = {name: [one for one in found if one[0] not in ABOARD] for name, found in systems.items()}
    assert not any(truths.values()), truths
    assert len(systems["gunnerus_dp"]) == 28
