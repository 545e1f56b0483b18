"""What `check` prints of a system: errors first, a line for each kind of remark, then the verdict."""

import pytest

from shipcosim.library import names

MOST_LINES = 3


@pytest.mark.parametrize("name", sorted(names("system")))
def test_few_lines_come_before_the_verdict_of_a_shipped_system(name, call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = call("check", name)
    *remarks, verdict = done.out.splitlines()
    assert done.code == 0 and verdict.startswith(f"{name}: ")
    assert len(remarks) <= MOST_LINES and all(line.startswith("remark: ") for line in remarks)


def test_every_unconnected_input_is_named(call, project):
    call("build")
    ssd = project / "ssp" / "tank" / "SystemStructure.ssd"
    ssd.write_text(
        ssd.read_text().replace(
            '<ssd:Connection startConnector="level_set" endElement="lag" endConnector="u"/>', ""
        )
    )
    done = call("check", "tank")
    assert done.code == 0 and "lag: u." in done.out


def test_errors_stand_before_remarks(call, project):
    call("build")
    scenario = project / "scenarios" / "fill.toml"
    text = scenario.read_text().replace('"lag.time_constant" = 0.5', '"lag.time_constant" = -1.0')
    # An event after the end never acts, which is a remark.
    scenario.write_text(text + '\n[[events]]\ntime = 9.0\noverride = { "lag.fails_at" = 1.0 }\n')
    said = call("check", "fill").out
    kinds = [
        line.partition(":")[0] for line in said.splitlines() if line.startswith(("error", "remark"))
    ]
    assert kinds == sorted(kinds) and set(kinds) == {"error", "remark"}


def test_what_several_places_have_in_common_stands_once(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = call("check", "kvlcc2_open", "--for", "libcosim")
    assert done.out.count("error: ") == 7 and done.out.count("refuses the system") == 1


def test_the_remedy_for_libcosim_makes_the_flagship_pass(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    failed = call("check", "gunnerus_dp", "--for", "libcosim")
    assert failed.code == 1 and "`shipcosim export osp`" in failed.out
    assert call("export", "osp", "gunnerus_dp", "--out", "osp").code == 0
    assert call("check", "osp", "--for", "libcosim").code == 0
