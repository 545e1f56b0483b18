"""The reference is complete: every command, key, FMU, public name and entry of diagnosis.json has its place."""

import re

import pytest

import shipcosim
from shipcosim.cli.outcomes.exits import EXIT_CODES
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.result import Diagnosis


@pytest.fixture(scope="module")
def look_up(generator):
    return generator("look_up")


def test_every_command_has_an_example_and_every_option_a_meaning(look_up):
    page = look_up.commands()
    for name, command in look_up.all_commands(look_up.command_group()):
        section = re.split(r"(?m)^## ", page.partition(f"## {name.partition(' ')[2]}\n")[2])[0]
        assert re.search(rf"```sh\n{name}\b", section), f"{name} shows no example"
        for parameter in command.params:
            if parameter.name != "help":
                assert look_up.help_of(name, parameter), f"{name} {parameter.opts}"
                assert parameter.opts[0] in section or parameter.param_type_name == "argument"


def test_every_key_of_a_file_has_a_meaning(look_up):
    missing = [
        f"{record.__name__}.{name}"
        for records in look_up.RECORDS.values()
        for record in records
        for name in record.model_fields
        if not look_up.meaning_of(record, name)
    ]
    assert missing == [], (
        "describe them by Field(description=...), or in docs/generators/meanings.toml"
    )


def test_every_meaning_belongs_to_a_key(look_up):
    known: dict[str, set] = {
        name: {parameter.opts[0] for parameter in command.params if not parameter.help}
        for name, command in look_up.all_commands(look_up.command_group())
    }
    for records in look_up.RECORDS.values():
        for record in records:
            known.setdefault(look_up.section_of(record), set()).update(record.model_fields)
    stale = [
        f"{section}.{name}"
        for section, entries in look_up.MEANINGS.items()
        for name in entries
        if name not in known.get(section, ())
    ]
    assert stale == []


def test_every_record_of_a_file_is_described(look_up):
    """A record that another one holds has a table of its own."""
    text = "".join(look_up.format_of(kind)() for kind in look_up.RECORDS)
    anchors = re.findall(r"\{ #([\w-]+) \}", text)
    assert set(re.findall(r"\]\(#([\w-]+)\)", text)) <= set(anchors)
    assert len(anchors) == len(set(anchors)) == sum(map(len, look_up.RECORDS.values()))


def test_numbers_of_a_ship_file_show_their_unit(look_up):
    text = look_up.format_of("ship")()
    assert "| `draught` | number in m |" in text and "| `turning_rate` | number in rad/s |" in text


def test_every_fmu_has_one_place(look_up, root):
    grouped = [name for names in look_up.FMUS.values() for name in names]
    there = {f.name for f in (root / "fmus").iterdir() if (f / f"{f.name}.py").is_file()}
    assert sorted(grouped) == sorted(there)


def test_every_public_name_is_shown(look_up):
    assert set(re.findall(r"heading: (\w+)", look_up.python_api())) == set(shipcosim.__all__)


def test_every_entry_of_diagnosis_json_is_explained(root):
    page = (root / "docs" / "diagnosis-json.md").read_text(encoding="utf-8")
    entries = set(Diagnosis("consistent").as_json())
    first = page.partition("## Verdicts")[0]
    assert set(re.findall(r"(?m)^\| `(\w+)` \|", first)) == entries
    shown = set(re.findall(r'(?m)^  "(\w+)":', page))
    assert shown == entries
    finding = page.partition("## A finding")[2].partition("## Details")[0]
    explained = set(re.findall(r"`(\w+)`", finding))
    assert (
        set(
            Finding(
                "x", kind="data", onset=1.0, course="step", note="n", alternatives=("a",)
            ).as_json()
        )
        <= explained
    )


def test_verdicts_are_those_of_a_diagnosis(root):
    page = (root / "docs" / "diagnosis-json.md").read_text(encoding="utf-8")
    table = page.partition("## Verdicts")[2].partition("## A finding")[0]
    explained = set(re.findall(r"(?m)^\| `(\w+)` \|", table))
    assert explained == set(
        re.findall(r"``\"(\w+)\"``", Diagnosis.__doc__.partition("findings :")[0])
    )


def test_exit_codes_of_the_page_are_those_of_the_commands(root):
    page = (root / "docs" / "exit-codes.md").read_text(encoding="utf-8")
    assert re.findall(r"(?m)^\| (\d+) \|", page) == re.findall(r"\b(\d+) [a-z]", EXIT_CODES)


def test_each_word_of_the_glossary_has_one_meaning(root):
    text = (root / "docs" / "glossary.md").read_text(encoding="utf-8")
    words = [
        word.strip()
        for entry in re.findall(r"(?m)^\| \*\*([^*]+)\*\*", text)
        for word in entry.split(",")
    ]
    assert len(words) > 70
    assert sorted(words) == sorted(set(words))
