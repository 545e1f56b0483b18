"""A check names file, line and remedy, finds everything at once and survives anything."""

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.ssp import check_file, check_system, read_system
from shipcosim.ssp.read.package import Package


def messages(problems):
    return "\n".join(str(problem) for problem in problems if problem.severity == "error")


def test_a_sound_system_has_no_errors_but_remarks_on_missing_binaries(shop):
    path = shop.fmu("one", "output y Real m")
    shop.ssd(shop.component("a", "one", "output y"))
    problems = check_system(shop.folder)
    assert messages(problems) == ""
    assert [problem.where for problem in problems] == [path.name]
    assert "no binary for this platform" in problems[0].found


def test_schema_and_meaning_are_reported_together(shop):
    shop.fmu("one", "output y Real m")
    shop.ssd(shop.component("a", "one", "output y", "output z") + '\n<ssd:Component name="b"/>')
    text = messages(check_file(shop.path))
    assert "line 10: Element 'Component': The attribute 'source' is required but missing." in text
    assert "one.fmu has no output 'z'. It has: y." in text


def test_broken_xml_is_named_with_its_line(shop):
    shop.ssd(shop.component("a", "one") + "<ssd:Component>")
    (problem,) = check_file(shop.path)
    assert problem.where == f"{shop.path}, line 9"
    assert "Not well-formed XML" in problem.found


def test_a_wrong_namespace_is_named_with_the_right_one(shop):
    shop.ssd("")
    shop.path.write_text(
        shop.path.read_text().replace("SSP1/SystemStructureDescription", "Draft/X")
    )
    assert 'xmlns="http://ssp-standard.org/SSP1/SystemStructureDescription"' in messages(
        check_file(shop.path)
    )


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\xff\xfe<\x00a\x00", "not UTF-8"),
        (b'<?xml version="1.0" encoding="ISO-8859-1"?><a>\xe4</a>', "not UTF-8"),
        (b"", "Not well-formed XML"),
        (b"<a>" * 5000, "Not well-formed XML"),
        (
            b'<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><a>&x;</a>',
            "document type declaration",
        ),
        (
            b'<!DOCTYPE a [<!ENTITY l "ha"><!ENTITY m "'
            + b"&l;" * 50
            + b'"><!ENTITY n "'
            + b"&m;" * 50
            + b'">]><a>&n;</a>',
            "document type declaration",
        ),
        (b"PK\x03\x04", "Not well-formed XML"),
    ],
    ids=["utf-16", "latin-1", "empty", "deep", "entity of a file", "many laughs", "archive"],
)
@pytest.mark.parametrize("name", ["x.ssd", "x.ssv", "x.ssm", "x.ssb"])
def test_hostile_xml_ends_in_a_clear_error(tmp_path, name, data, message):
    (tmp_path / name).write_bytes(data)
    (problem,) = check_file(tmp_path / name)
    assert message in problem.found
    assert "root:" not in str(problem)


def test_a_missing_file_and_an_unknown_ending_are_errors(tmp_path):
    assert "There is no such file" in messages(check_file(tmp_path / "x.ssp"))
    assert "No such file" in messages(check_file(tmp_path / "x.ssv"))
    assert "Files ending in '.doc' are not known." in messages(check_file(tmp_path / "x.doc"))


def test_a_set_and_a_mapping_are_checked_alone(shop, real):
    assert check_file(shop.ssv(real("a", "1", "m"))) == []
    assert "'one' is not a number" in messages(check_file(shop.ssv(real("a", "one"))))
    shop.ssm('<ssm:MappingEntry source="a" target="c"/><ssm:MappingEntry source="b" target="c"/>')
    assert "'a' is mapped to this parameter already." in messages(
        check_file(shop.folder / "resources/names.ssm")
    )


def test_names_that_are_not_unique_are_refused(shop):
    shop.fmu("one", "output y Real m")
    shop.ssd(shop.component("a", "one", "output y", "output y") + shop.component("a", "one"))
    text = messages(check_file(shop.path))
    assert "a has a second connector 'y'." in text
    assert "test has a second element 'a'." in text


def test_ssp_2_types_are_read(shop):
    shop.fmu("one", "output y Real m")
    shop.ssd(shop.component("a", "one", 'output y <ssc:Float64 unit="m"/>'))
    shop.path.write_text(
        shop.path.read_text().replace('version="1.0" name="test"', 'version="2.0" name="test"')
    )
    assert messages(check_file(shop.path)) == ""
    shop.path.write_text(shop.path.read_text().replace('kind="output"', 'kind="outputt"'))
    assert "The kind of connector 'outputt' does not exist." in messages(check_file(shop.path))


@pytest.mark.parametrize("name", ["#", "a#b", "100%", "ü ö", "x;y"])
def test_a_file_is_checked_in_a_folder_of_any_name(shop, name):
    folder = shop.folder / name
    folder.mkdir()
    path = shop.fmu("one", "output y Real m").rename(folder / "one.fmu")
    assert messages(check_file(path)) == ""


@pytest.mark.parametrize("name", ["a\x1bb.fmu", "a\x07.fmu", "a\x9b31m.fmu", "a\u202eb.fmu"])
def test_an_fmu_with_control_characters_in_its_name_is_no_system(shop, name):
    path = shop.fmu("one", "output y Real m").rename(shop.folder / name)
    with pytest.raises(ShipcosimError, match="Its file name has control characters"):
        read_system(path)


def test_a_file_that_many_elements_miss_is_sought_once_and_reported_for_each(shop, monkeypatch):
    """The folders were searched for every element: two megabytes of them took twelve seconds."""
    sought = []
    locate = Package.locate
    monkeypatch.setattr(
        Package, "locate", lambda *given: (sought.append(given[1]), locate(*given))[1]
    )
    shop.ssd("".join(shop.component(f"a{i}", "one") for i in range(50)))
    found = [problem for problem in check_file(shop.path) if "does not exist" in problem.found]
    assert len({problem.where for problem in found}) == len(found) == 50
    assert len({(problem.found, problem.remedy) for problem in found}) == 1 and len(sought) == 1
