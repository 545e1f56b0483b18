"""An exported system gives the values of the system, whatever units and transformations are on its ways."""

import numpy as np
import pytest

from shipcosim.cosim import RunOptions, export_fmu, simulate
from shipcosim.cosim.export.osp import write_osp
from shipcosim.errors import ShipcosimError
from shipcosim.ssp import read_system

LINEAR = '<ssc:LinearTransformation factor="-0.5" offset="1"/>'
WAYS = [
    "shaft.rpm -> other.speed",
    f"shaft.rpm -> other.speed|{LINEAR}",
    "turn -> shaft.speed",
    f"turn -> shaft.speed|{LINEAR}",
    "course -> other.angle",
    f"course -> other.angle|{LINEAR}",
]
CONNECTORS = {
    "turn": ("input", "Real", 'unit="rpm"'),
    "course": ("input", "Real", 'unit="rad"'),
}


def system_of(make_system, ways):
    """System of these connections, and the start values of its inputs, which differ from those of its FMUs."""
    parts = {"shaft": ("shaft", {"speed": 2.0, "angle": 30.0}), "other": "shaft"}
    inputs = [name for name in CONNECTORS if any(way.startswith(name) for way in ways)]
    system = make_system(parts, ways, {name: CONNECTORS[name] for name in inputs})
    return system, {name: 3.0 for name in inputs}


@pytest.mark.parametrize("ways", [*([way] for way in WAYS), [WAYS[1], WAYS[3], WAYS[4]]])
def test_osp(make_system, make_scenario, tmp_path, ways):
    system, values = system_of(make_system, ways)
    scenario = make_scenario(1.0, 0.1, set=values)
    write_osp(system, scenario, tmp_path / "osp")
    ours = simulate(system, scenario)
    exported = read_system(tmp_path / "osp")
    engines = ["fmpy", "libcosim"] if pytest.importorskip("libcosimpy") else ["fmpy"]
    for engine in engines:
        theirs = simulate(exported, make_scenario(1.0, 0.1), RunOptions(engine=engine))
        for name in set(ours.data_vars) & set(theirs.data_vars):
            assert np.allclose(ours[name], theirs[name], rtol=1e-9, atol=1e-9), (engine, name)


@pytest.mark.parametrize("way", WAYS)
def test_fmu(make_system, make_scenario, tmp_path, way):
    """The container copies values as they are: what changes on its way is refused."""
    system, _ = system_of(make_system, [way])
    (connection,) = system.connections
    assert (connection.factor, connection.offset) != (1.0, 0.0)
    with pytest.raises(ShipcosimError, match="copies values as they are"):
        export_fmu(system, tmp_path / "all.fmu", 0.1)
