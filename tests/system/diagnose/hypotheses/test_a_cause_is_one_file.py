"""A new cause takes one file: nothing in the code knows a cause by its name."""

import ast
import json
import re

import pytest
from diagnose import twin
from typer.testing import CliRunner

from shipcosim.cli import app
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue, read_faults
from shipcosim.series import write_table
from shipcosim.ssp import read_system

DAMPING = -25e3  # N.s/m
FILE = """
cause = "sway_damping"
sentence = "Something along the hull resists sway in proportion to its speed"
statement = "she resists sway by {damping:signed less|more} than modelled"
next_step = "Look for what hangs along the hull: fenders, fish doors, a boom."
reference = "Linear damping; no cause of the catalogue turns it"
why_not_testable = "she moved sideways at {sway} (rms)"
least = 0.3

[parameters.damping]
of = ["vessel.Y_v"]
unit = "N.s/m"
typical = 20e3
tolerance = 500.0
bounds = [-200e3, 200e3]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Results of the log of a ship with linear sway damping, diagnosed with a file that describes it."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "causes").mkdir()
    (folder / "causes" / "sway_damping.toml").write_text(FILE, encoding="utf-8")
    write_table(
        twin.sailed({"own": {"vessel.Y_v": DAMPING}}, minutes=10.0)["own"], folder / "log.csv"
    )
    command = ["diagnose", "log.csv", "--effects", "causes", "--out", "results"]
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        ran = CliRunner().invoke(
            app, [*command, "--system", str(twin.ROOT / "ssp" / "gunnerus_open")]
        )
    assert ran.exit_code == 1, ran.output  # something is wrong with the model
    return folder / "results"


def found(folder):
    return json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))


def test_planted_cause_of_a_new_file_is_named_with_its_size(folder):
    (finding,) = found(folder)["findings"]
    assert (found(folder)["verdict"], finding["cause"], finding["component"]) == (
        "named",
        "sway_damping",
        None,
    )
    damping = finding["parameters"]["damping"]
    assert abs(damping["estimate"] - DAMPING) < 3.0 * damping["std"] and damping["unit"] == "N.s/m"


def test_page_explains_the_cause_of_a_new_file(folder):
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert re.search(r"she resists sway by \d+ ± \d+ N.s/m more than modelled", page)
    assert "Sway damping" in page and "fenders, fish doors, a boom" in page


def test_system_is_extended_by_the_cause_of_a_new_file_and_its_gain_is_measured(folder):
    (finding,), gain = found(folder)["findings"], found(folder)["gain"]
    extended = read_system(str(folder / "extended.ssp"))
    assert extended.components["vessel"].start["Y_v"] == pytest.approx(
        finding["parameters"]["damping"]["estimate"]
    )
    assert gain["after_m"] < gain["before_m"] and gain["share_of_explainable"] > 0.5


DEFINE_NUMBERS = ("models/", "diagnose/ship/")
"""Folders that define numbers of the ship, after which some causes are called: ``{thruster}.thrust_loss``."""


def texts_and_names(file):
    """Strings of a module that are no docstrings, and its names that are no attributes, each with its line."""
    tree, texts, names = ast.parse(file.read_text(encoding="utf-8")), [], []
    told = [node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)]
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in told:
            texts.append((node.value, node.lineno))
        elif isinstance(node, (ast.Name, ast.arg, ast.FunctionDef, ast.ClassDef)):
            names.append(
                (getattr(node, "id", None) or getattr(node, "arg", None) or node.name, node.lineno)
            )
    return texts, names


def test_no_cause_is_known_to_the_code_by_its_name(root):
    """Nowhere by a name such as ``wind_scale``; one that is an ordinary word, as ``mass``, is no text by itself."""
    source, causes = root / "src" / "shipcosim", read_catalogue()
    for file in sorted(source.rglob("*.py")):
        place = file.relative_to(source).as_posix()
        texts, names = texts_and_names(file)
        if not place.startswith(DEFINE_NUMBERS):
            for text, line in texts + names:
                known = {word for word in re.findall(r"\w+", text) if "_" in word} & set(causes)
                assert not known, f"{place}, line {line}: {text!r}"
        if place.startswith(("diagnose/", "report/diagnosis/")) and not place.startswith(
            DEFINE_NUMBERS
        ):
            assert not [(text, line) for text, line in texts if text in causes], place


def test_pages_know_no_fault_of_the_log_by_its_name(root):
    for file in sorted((root / "src" / "shipcosim" / "report" / "diagnosis").rglob("*.py")):
        assert not [
            (text, line) for text, line in texts_and_names(file)[0] if text in read_faults()
        ], file.name
