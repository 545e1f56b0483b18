"""Odd texts in names, messages and numbers: what they say stays text, in JUnit, JSON, terminal and settings."""

import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest
from cli.conftest import SCENARIO, SSD
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcosim.cli.outcomes.junit import junit_xml
from shipcosim.cli.terminal import make_console, say_json
from shipcosim.results.shown import Check
from shipcosim.ssp import settings_for

TEXTS = st.text(st.characters(exclude_categories=()), min_size=1, max_size=30)
ODD = (
    "[red]a[bold]",
    "[",
    "{0} {x}",
    "100 %d %s",
    ":cat:",
    "a\x1b[31m",
    "\x9b2J",
    "\x7f",
    "\ufffe",
)


@given(suite=TEXTS, group=TEXTS, name=TEXTS, message=TEXTS)
@settings(max_examples=200, deadline=None)
def test_any_text_makes_xml_that_can_be_read(suite, group, name, message):
    checks = [Check(name, "failed", message, group=group)]
    root = ElementTree.fromstring(junit_xml(suite, checks, Path(suite.replace("\x00", ""))))
    assert len(list(root.iter("testcase"))) == 1


@given(text=TEXTS)
@settings(max_examples=200, deadline=None)
def test_any_text_makes_json_without_control_characters(text):
    shown = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("typer.echo", shown.append)
        say_json({text: [text]})
    assert json.loads(shown[0]) == {text: [text]}
    assert not any(0x7F <= ord(c) < 0xA0 or (ord(c) < 32 and c not in "\n\t") for c in shown[0])


@pytest.mark.parametrize("text", [*ODD[:5], "[red]a[/red]", "[/]"])
def test_markup_of_rich_is_text_like_any_other(text, capsys):
    make_console(soft_wrap=True, stderr=True).print(text)
    assert capsys.readouterr().err == f"{text}\n"


@pytest.mark.parametrize("name", ODD[:-1])
def test_a_scenario_of_any_name_and_description_runs(call, project, name):
    fails = SCENARIO.replace("near   = 1.0", "near   = 2.0").replace(
        "Filling a tank", json.dumps(name)[1:-1]
    )
    (project / "scenarios" / f"{name}.toml").write_text(fails, encoding="utf-8")
    ended = call("run", f"scenarios/{name}.toml", "--junit", "found.xml", "--json")
    assert (ended.code, json.loads(ended.out)["name"]) == (1, name)
    assert ElementTree.parse("found.xml").getroot().find("testsuite").get("failures") == "1"


@pytest.mark.skipif(os.name == "nt", reason="file names are UTF-16 there")
def test_a_file_whose_name_is_no_text_is_refused_with_the_remedy(call, project):
    path = os.fsdecode(b"scenarios/f\xff.toml")
    Path(path).write_text(SCENARIO, encoding="utf-8")
    ended = call("run", "scenarios")
    assert ended.code == 2 and "Rename the file." in ended.err
    command = "from shipcosim.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", command, "run", path], capture_output=True, text=True
    )
    assert done.returncode == 2 and "no text in UTF-8. Rename the file." in done.stderr


@pytest.mark.parametrize(
    ("given", "right"),
    [
        ({"a": "b=7"}, {"a=b": 7}),
        ({"a": "b=7 kn"}, {"a=b": "7 kn"}),
        ({"a": "b=c=true"}, {"a=b=c": True}),
        ({"a": "x=7"}, {"a": "x=7"}),
        ({"a": 7}, {"a": 7}),
        ({"z": "b=7"}, {"z": "b=7"}),
        ({"lag.u": "=7"}, {"lag.u=": 7}),
    ],
)
def test_of_names_with_an_equals_sign_the_longest_is_set(given, right):
    variables = dict.fromkeys(["u", "u="], None)
    component = SimpleNamespace(name="lag", variables=variables)
    system = SimpleNamespace(
        file="a.ssd",
        inputs=dict.fromkeys(["a", "a=b"]),
        parameters={"a=b=c": None},
        components={"lag": component},
    )
    assert settings_for(system, given) == right


def test_a_setting_reaches_a_name_with_an_equals_sign(call, project):
    (project / "ssp/tank/SystemStructure.ssd").write_text(
        SSD.replace("level_set", "level=set"), encoding="utf-8"
    )
    ended = call("run", "scenarios/fill.toml", "--set", "level=set=2", "--json")
    assert json.loads(ended.out)["expectations"][0]["worst"] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("value", ["1e300", "-1e308", "1.7e308", "1e-300", "1e400", "nan", "inf"])
@pytest.mark.parametrize("where", ["set", "near", "within", "event"])
def test_numbers_at_the_ends_of_the_range_end_in_a_result_or_an_error(call, project, where, value):
    text = SCENARIO + '\n[[events]]\ntime = 1.0\noverride = { "lag.u" = 1.0 }\n'
    given = {"near": "near   = 1.0", "within": "within = 0.05", "event": '"lag.u" = 1.0'}.get(where)
    if given:
        text = text.replace(given, f"{given.split('=')[0]}= {value}")
    (project / "scenarios" / "fill.toml").write_text(text, encoding="utf-8")
    more = ["--set", f"level_set={value}"] if where == "set" else []
    ended = call("run", "scenarios/fill.toml", *more)
    said = ended.out + ended.err
    assert ended.code in (0, 1, 2) and "fault of shipcosim" not in said and "Warning" not in said
    assert (ended.code == 2) == (value in ("1e400", "nan", "inf") or (where, value) in REFUSED)


REFUSED = {("within", "-1e308")}
"""Beside numbers that are none."""


def test_a_list_of_any_length_stands_in_one_line(call, project):
    levels = ", ".join(f"{number}.25" for number in range(5000))
    study = f"""description = "Many levels"
scenario = "fill"

[[factor]]
name = "level"
signal = "level_set"
values = [{levels}]

[[quantity]]
name = "end"
signal = "lag.y"
reduce = "final"
"""
    (project / "studies").mkdir()
    (project / "studies" / "many.toml").write_text(study, encoding="utf-8")
    call("build")
    ended = call("check", "studies/many.toml")
    assert ended.code == 0, ended.out
