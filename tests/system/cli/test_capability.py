"""The command `capability`: what it leaves, what it prints, what it refuses."""

import json

import pytest

from shipcosim.series import read_columns

FILES = ["capability.csv", "capability.nc", "report.html"]


def test_default_is_the_lengthened_ship(call, gunnerus):
    done = call("capability")
    folder = gunnerus / "results" / "capability-gunnerus-33m9"
    assert done.code == 0 and done.out.startswith("DP capability-L1(")
    assert sorted(path.name for path in folder.iterdir()) == FILES
    columns = read_columns(folder / "capability.csv")
    assert columns["weather_from"][1] == "deg" and len(columns["level 1, intact"][0]) == 36
    assert "DP capability-L1(" in (folder / "report.html").read_text(encoding="utf-8")


def test_parameters_and_ship_are_found_by_name_and_groups_are_added(call, gunnerus, tmp_path):
    out = tmp_path / "here"
    options = [
        "--parameters",
        "gunnerus-28m9",
        "--failure",
        "port,starboard",
        "--json",
        "--out",
        str(out),
    ]
    done = call("capability", "gunnerus_dp", *options)
    said = json.loads(done.out)
    assert (
        done.code == 0
        and said["schema"] == "shipcosim-capability/1"
        and said["ship"] == "gunnerus-28m9"
    )
    assert "without port and starboard" in said["numbers"]["level 1"]
    assert (
        said["notation"] == f"DP capability-L1({said['A']}, {said['B']}, {said['C']}, {said['D']})"
    )
    assert sorted(path.name for path in out.iterdir()) == FILES


def test_a_packed_system_knows_her_ship_by_its_parameter_set(call, gunnerus):
    call("build", "gunnerus_dp")
    done = call("capability", "build/ssp/gunnerus_dp.ssp")
    assert done.code == 0 and "of gunnerus-33m9" in done.out


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["gunnerus_pd"], ["gunnerus_pd", "There is no such system", "gunnerus_dp"]),
        (["--ship", "gunnerus-33m8"], ["There is no ship", "gunnerus-33m9"]),
        (["--failure", "port,bow"], ["'bow' is no thruster", "tunnel"]),
        (["--parameters", "nothing.ssv"], ["nothing.ssv"]),
        (["scenarios/short.toml"], ["scenarios/short.toml"]),
    ],
)
def test_what_is_not_there_is_refused_with_what_there_is(call, gunnerus, arguments, words):
    done = call("capability", *arguments)
    assert done.code == 2 and all(word in done.err for word in words)
    assert "Traceback" not in done.err and not (gunnerus / "results").exists()
