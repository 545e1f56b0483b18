"""Every shipped component, as the scenarios use it, and every ship of `new ship` has C code."""

from dataclasses import replace

import pytest
from typer.testing import CliRunner

import shipcosim
from shipcosim.cli.app import app
from shipcosim.cosim.systems import system_of
from shipcosim.cosim.webassembly.module import NotForPages, texts_of
from shipcosim.native import component
from shipcosim.native.source import source_of
from shipcosim.scenario import read_scenario

IN_PYTHON = {
    "dead_reckoning": "it reads files",
    "docking_predictor": "it reads files",
    "helmsman": "fairway.py",
    "paper_i_allocator": "it reads files",
    "paper_v_allocator": "it reads files",
}
"""FMUs without C code, as docs/live.md says, and a part of the reason."""


def without_code(scenario, skipped=()):
    """Reason for each FMU of a scenario's system that has no C code, by the FMU's name."""
    system = system_of(read_scenario(scenario))
    kept = {name: c for name, c in system.components.items() if c.fmu.path.stem not in skipped}
    system = replace(system, components=kept)
    try:
        texts_of(system)
    except NotForPages as error:
        return {system.components[p.where].fmu.path.stem: p.found for p in error.problems}
    return {}


def test_all_components_of_all_scenarios_have_c_code_but_those_that_the_docs_name(root):
    found = {}
    for file in sorted((root / "scenarios").rglob("*.toml")):
        found |= without_code(file)
    assert set(found) == set(IN_PYTHON)
    for name, reason in found.items():
        assert IN_PYTHON[name] in reason


def test_the_c_text_of_the_dp_system_stays_short(root, monkeypatch):
    file = root / "scenarios" / "four_corner.toml"
    exported = {n: text.count("\n") for n, text in texts_of(system_of(read_scenario(file))).items()}
    # What the engine records is counted in a run of a second that takes no record from the cache.
    recorded = []

    def counted(step):
        text = source_of(step)
        recorded.append(text.count("\n"))
        return text

    monkeypatch.setattr(component, "source_of", counted)
    monkeypatch.setattr(component, "kept_record", lambda *_: None)
    shipcosim.run(str(file), engine="native", until=1.0)
    print("C text of four_corner:", sum(exported.values()), exported, sum(recorded), recorded)
    assert len(recorded) == len(exported)
    assert sum(exported.values()) < 31_000 and sum(recorded) < 8_000


@pytest.mark.parametrize(
    ("propulsion", "length", "breadth", "draught"),
    [
        ("azimuths", "110 m", "22 m", "6 m"),
        ("screws", "30 m", "8 m", "2.5 m"),
    ],
)
def test_a_new_ship_has_c_code(tmp_path, monkeypatch, propulsion, length, breadth, draught):
    (tmp_path / "scenarios").mkdir()
    monkeypatch.chdir(tmp_path)
    sizes = ["--length", length, "--breadth", breadth, "--draught", draught]
    options = ["--propulsion", propulsion, "--yes"]
    made = CliRunner().invoke(app, ["new", "ship", "tern", *sizes, *options])
    assert made.exit_code == 0, made.output
    # These take long to record, and only their numbers differ from those of the shipped systems.
    alike = ("dp_controller", "sensors", "environment")
    assert not without_code(tmp_path / "scenarios" / "tern.toml", skipped=alike)
