"""The studies that come with the project, each in its small form: what they find, and that their pages draw it."""

import numpy as np
import pandas
import pytest

import shipcosim
from shipcosim.capability import capability_of, cases_of, vessel_of
from shipcosim.capability.conditions import CONDITIONS
from shipcosim.report.study import tables_of
from shipcosim.report.study.page import page_of
from shipcosim.sweep import plan_of, read_study
from shipcosim.sweep.summary import summarised


@pytest.fixture(scope="module")
def swept(root, tmp_path_factory):
    """Function that runs a study of the project by name, once, and gives what it left and its page."""
    done = {}

    def run(name):
        if name not in done:
            found = shipcosim.sweep(
                root / "studies" / f"{name}.toml", out=tmp_path_factory.mktemp(name), workers=1
            )
            done[name] = found, page_of(tables_of(found, name))
        return done[name]

    return run


# ---- dp_capability


def test_dp_capability_loses_each_thruster_and_each_bus_of_the_ship(root):
    plan = plan_of(read_study(root / "studies" / "dp_capability.toml"))
    vessel = vessel_of("gunnerus_dp", ["gunnerus-33m9"])
    lost = next(
        levels
        for factor, levels in zip(plan.study.factor, plan.levels, strict=True)
        if factor.name == "lost"
    )
    assert [level.label for level in lost] == [case.name for case in cases_of(vessel)]
    changed = {name for level in lost for event in level.events for name in event.override}
    assert changed == {
        *(f"{thruster.name}.failed" for thruster in vessel.thrusters),
        "allocator.bus_a_power",
    }


def test_conditions_and_directions_are_those_of_the_static_capability(swept):
    plan = swept("dp_capability_small")[0].plan
    for run in (plan.run(number) for number in range(len(plan))):
        weather = CONDITIONS[run.columns["condition"] - 1]
        away = np.radians(run.columns["weather_from"])
        found = [
            run.values[f"environment.{name}"] for name in ("wind_from", "waves_from", "current_to")
        ]
        assert np.exp(1j * np.array(found)) == pytest.approx(
            np.exp(1j * away) * np.array([1, 1, -1])
        )
        assert run.values["environment.wind_speed"] == weather.wind_speed
        assert run.values["environment.significant_wave_height"] == weather.wave_height
        assert run.values["environment.peak_period"] == weather.wave_period
        assert run.values["environment.current_speed"] == weather.current_speed


def test_dp_capability_is_the_last_condition_that_its_seeds_hold(swept):
    found, _ = swept("dp_capability_small")
    assert (found.runs["error"] == "").all()
    for row in found.summary.itertuples():
        alike = found.runs.query("weather_from == @row.weather_from and lost == @row.lost")
        shares = alike.groupby("condition")["held"].mean()
        held = [number for number in (1, 4) if (shares.loc[:number] >= 0.9).all()]
        assert row.number == (held[-1] if held else 0)
    numbers = found.summary.set_index(["lost", "weather_from"])["number"]
    assert numbers["intact"].tolist() == [4, 1, 4, 1], (
        "from ahead and astern she holds more than from abeam"
    )
    assert numbers["without tunnel"].tolist() == [0, 0, 4, 0], (
        "she turns her stern to the weather, if it is not there"
    )


def test_page_of_dp_capability_has_the_static_numbers_beside_it(swept):
    _, page = swept("dp_capability_small")
    assert page.remarks == []
    intact, lost, position = page.plots
    capability = capability_of(vessel_of("gunnerus_dp", ["gunnerus-33m9"]))
    curves = {trace["name"]: trace for trace in intact.traces}
    assert list(curves) == [
        "intact",
        "intact: static, simulator's models",
        "intact: static, Level 1",
    ]
    for basis, name in (
        ("simulator", "static, simulator's models"),
        ("level 1", "static, Level 1"),
    ):
        assert curves[f"intact: {name}"]["r"][:-1] == capability.numbers(basis)[0].tolist()
    assert [trace["name"] for trace in lost.traces if "static" in trace["name"]] == [
        "intact: static, simulator's models",
        "without tunnel: static, simulator's models",
    ]
    assert [trace["name"] for trace in position.traces] == ["intact", "without tunnel"]


# ---- failures


def test_failures_has_every_failure_of_every_thruster(root):
    plan = plan_of(read_study(root / "studies" / "failures.toml"))
    caused = {name for level in plan.levels[0] for event in level.events for name in event.override}
    possible = {
        f"{thruster}.{name}"
        for thruster in ("port", "starboard", "tunnel")
        for name, variable in plan.system.components[thruster].fmu.variables.items()
        if variable.causality == "input" and name != "stop"  # which the monitor gives
        if variable.kind == "Boolean" or name in ("rate_share", "power_limit")
    }
    assert caused == possible and len(plan.levels[0]) == len(possible)


def test_failures_say_how_far_and_how_soon_seen_as_a_run_alone_does(swept):
    found, page = swept("failures_small")
    runs = found.runs.set_index(["failure", "seed"])
    alone = found.run(int(runs.loc[("port: full thrust", 1), "run"]))
    after = alone["time"].values >= 200.0
    distance = np.hypot(alone["vessel.x"].values, alone["vessel.y"].values)[after]
    assert runs.loc[("port: full thrust", 1), "excursion"] == pytest.approx(distance.max())
    turned = np.abs(alone["vessel.psi"].values[after]).max()
    assert runs.loc[("port: full thrust", 1), "turned"] == pytest.approx(turned), "either way"
    seen = alone["time"].values[alone["monitor.port_faulty"].values.astype(bool)][0] - 200.0
    assert runs.loc[("port: full thrust", 1), "seen"] == seen and 6.0 <= seen < 8.0
    summary = found.summary.set_index("failure")
    assert summary.loc["port: frozen angle", "seen_90"] == np.inf, "a frozen angle is not seen"
    assert summary.loc["port: full thrust", "seen_90"] == pytest.approx(
        runs.loc["port: full thrust", "seen"].max()
    )
    _, seen_by = page.plots[:2]
    bars = {
        trace["name"]: dict(zip(trace["y"], trace["x"], strict=True)) for trace in seen_by.traces
    }
    assert bars["seen_90"]["port: frozen angle"] is None
    assert page.summary.rows[-1][5].startswith("never")


# ---- drift_off


def test_times_of_a_drift_off_are_those_of_its_tracks(swept):
    found, _ = swept("drift_off_small")
    assert (found.runs["error"] == "").all() and found.runs["held_before"].astype(bool).all()
    tracks = pandas.read_parquet(found.folder / "tracks.parquet")
    assert set(tracks["run"]) == set(found.runs["run"])
    for row in found.runs.itertuples():
        track = tracks[tracks["run"] == row.run]
        assert np.diff(np.asarray(track["time"])) == pytest.approx(5.0)
        time = np.asarray(track["time"])
        distance = np.hypot(np.asarray(track["vessel.x"]), np.asarray(track["vessel.y"]))
        for radius in (10, 25, 50):
            beyond = time[distance > radius]
            first = beyond[0] - 120.0 if len(beyond) else np.inf
            reached = getattr(row, f"to_{radius}_m")
            reached = np.inf if np.isnan(reached) else reached
            assert reached == first == np.inf or first - 5.0 <= reached <= first


def test_samples_of_a_drift_off_are_alike_for_both_losses(swept):
    found, page = swept("drift_off_small")
    weather = found.runs.set_index(["lost", "sample"])[
        ["wind", "current_to", "wave_height", "weather_seed"]
    ]
    assert (weather.loc["all power"] == weather.loc["bus A"]).all(axis=None)
    (tracks,) = page.tracks
    assert [one["count"] for one in tracks.data["series"]] == [8, 8] and tracks.data["toScale"]
    hull = found.plan.system.components["vessel"]
    assert max(tracks.data["hull"][0]) == pytest.approx(hull.start_value("length") / 2)


def test_share_that_never_leaves_is_above_all_times(swept):
    found, _ = swept("drift_off_small")
    shorter = found.runs.copy()
    late = shorter["to_50_m"] > shorter["to_50_m"].median()
    shorter.loc[late, "to_50_m"] = np.nan  # as if their runs had ended before
    summary = summarised(found.plan, shorter)
    assert np.isinf(summary["to_50_m_90"]).all()
    assert (summary["to_50_m_10"] <= found.summary["to_50_m_50"]).all()
    assert summary["to_10_m_90"].tolist() == found.summary["to_10_m_90"].tolist()
