"""A predictor knows what the ship knows: none of its inputs is a truth of the simulation."""

from xml.etree import ElementTree

SSP = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"
ABOARD = {"dp_controller", "allocator", "sensors", "reference"}
"""FMUs whose outputs a ship has: what she measures, estimates and commands. Thrusters, vessel and weather are not."""
LEVERS = {
    f"{name}_cmd"
    for name in ("port_thrust", "port_azimuth", "starboard_thrust", "starboard_azimuth")
}
OF_UNITS = {"azimuth_thruster": {"rpm", "azimuth_feedback"}, "tunnel_thruster": {"rpm"}}
"""What is measured at thrusters: speeds and directions, no thrust."""
MEASURED = OF_UNITS | {"helmsman": LEVERS | {"tunnel_thrust_cmd"}}
"""Single outputs that a ship has; what a helmsman thinks is not among them."""


def sources_of_predictors(structure):
    """Connections into predictors: the FMU and the connector that each comes from."""
    root = ElementTree.parse(structure).getroot()
    fmus = {
        one.get("name"): one.get("source").rpartition("/")[2]
        for one in root.iter(f"{SSP}Component")
    }
    return [
        (fmus.get(line.get("startElement"), "").removesuffix(".fmu"), line.get("startConnector"))
        for line in root.iter(f"{SSP}Connection")
        if fmus.get(line.get("endElement"), "").endswith("predictor.fmu")
    ]


def test_no_input_of_a_predictor_is_a_truth_of_the_simulation(root):
    """Of the DP ship all inputs are connected, each to something aboard; no other system may do otherwise."""
    systems = {
        path.parent.name: sources_of_predictors(path) for path in (root / "ssp").glob("*/*.ssd")
    }
    truths = {
        name: [
            (fmu, output)
            for fmu, output in found
            if fmu not in ABOARD and output not in MEASURED.get(fmu, ())
        ]
        for name, found in systems.items()
    }
    assert not any(truths.values()), truths
    assert len(systems["gunnerus_docking"]) == 18
    assert len(systems["gunnerus_dp"]) == 28
