"""Names that FMI and SSP allow go through a run, its files, its page and back as inputs."""

import numpy as np
import pytest

import shipcosim as sc
from shipcosim.diagnose.log.reader import columns_of
from shipcosim.series import make_table, read_table, write_table

STRANGE = [
    "a, b [m]",
    'say "y"',
    "x/y",
    "sp ace ",
    "#1",
    "der(v)",
    "p[1,2].q",
    "50%",
    "ø;µ",
    "time 2",
]
SCRIPT = """
from pythonfmu import Fmi2Slave, Fmi2Causality, Real

NAMES = {names!r}


class Strange(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.held = dict.fromkeys(NAMES, 0.0)
        for name in NAMES:
            self.register_variable(Real(f"in {{name}}", causality=Fmi2Causality.input, start=0.0,
                getter=lambda n=name: self.held[n], setter=lambda v, n=name: self.held.__setitem__(n, v)))
            self.register_variable(Real(name, causality=Fmi2Causality.output, getter=lambda n=name: 2.0 * self.held[n]))

    def do_step(self, t, h):
        return True
"""


@pytest.fixture
def strange(tmp_path):
    from pythonfmu.builder import FmuBuilder

    script = tmp_path / "strange.py"
    script.write_text(SCRIPT.format(names=STRANGE))
    return FmuBuilder.build_FMU(script, tmp_path)


def test_strange_names_are_kept(strange, tmp_path):
    columns = [(f"in {name}", np.full(3, float(i)), "", "") for i, name in enumerate(STRANGE)]
    inputs = make_table(np.arange(3.0), columns)
    for suffix in (".csv", ".nc"):
        write_table(inputs, tmp_path / f"inputs{suffix}")
        table = read_table(tmp_path / f"inputs{suffix}")
        times = {"stop_time": 2.0, "step_size": 0.5}
        done = sc.simulate(strange, inputs=table, out=tmp_path / "out", force=True, **times)
        for i, name in enumerate(STRANGE):
            assert float(done[f"Strange.{name}"][-1]) == 2.0 * i
        for file in ("result.nc", "result.csv"):
            again = read_table(tmp_path / "out" / file)
            assert list(again.data_vars) == list(done.table.data_vars)
        assert set(columns_of(tmp_path / "out" / "result.csv").values) == {
            "time",
            *map(str, done.table.data_vars),
        }
        assert (tmp_path / "out" / "report.html").is_file()
