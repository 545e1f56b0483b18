"""Answers are judged as the definitions in `scoring` say, and runs can be taken up again."""

import math

import pytest

from trial import runs, tables
from trial.scoring import score

SPAN = (0.0, 2400.0)
HEALTHY = {"verdict": "consistent", "findings": []}


def hidden(cause, component=None, parameters=(), segments=(), channels=(), onset=0.0):
    return {
        "cause": cause,
        "component": component,
        "parameters": dict(parameters),
        "segments": segments,
        "channels": channels,
        "onset": onset,
        "note": "",
    }


def found(cause, component=None, values=(), std=0.1, unit="1", **more):
    values = {
        name: {"estimate": value, "std": std, "unit": unit} for name, value in dict(values).items()
    }
    return {"cause": cause, "component": component, "parameters": values} | more


def named(*findings, **more):
    return {"verdict": "named", "findings": list(findings)} | more


def test_a_healthy_log_wants_consistent_and_all_else_is_an_alarm():
    assert score([], HEALTHY, SPAN).right and not score([], HEALTHY, SPAN).alarm
    for verdict in ("unknown", "ambiguous"):
        assert score([], {"verdict": verdict, "findings": []}, SPAN).alarm
    judged = score([], named(found("mass")), SPAN)
    assert judged.alarm and judged.named and not judged.right and not judged.precise


def test_two_causes_want_both_and_nothing_else():
    both = [hidden("mass"), hidden("tow")]
    assert score(both, named(found("tow"), found("mass")), SPAN).right
    one = score(both, named(found("tow")), SPAN)
    assert one.precise and not one.right
    three = score(both, named(found("tow"), found("mass"), found("drag")), SPAN)
    assert not three.right and not three.precise


def test_the_set_of_an_ambiguous_answer_must_hold_what_is_hidden():
    ambiguous = {
        "verdict": "ambiguous",
        "findings": [],
        "indistinguishable": [found("tow"), found("wave_drift")],
    }
    assert score([hidden("tow")], ambiguous, SPAN).contained
    assert not score([hidden("tow")], ambiguous, SPAN).right
    assert not score([hidden("current")], ambiguous, SPAN).contained


def test_an_effect_outside_the_catalogue_wants_unknown():
    assert score([hidden("unknown")], {"verdict": "unknown", "findings": []}, SPAN).right
    assert not score([hidden("unknown")], named(found("mass")), SPAN).right
    assert not score([hidden("unknown")], HEALTHY, SPAN).right


def test_a_miss_is_excused_where_the_log_could_not_show_the_cause():
    assert score([hidden("mass")], HEALTHY | {"not_testable": ["mass"]}, SPAN).excused
    assert not score([hidden("mass")], HEALTHY | {"not_testable": ["drag"]}, SPAN).excused


def test_an_error_is_relative_to_the_distance_from_neutral_and_a_vector_is_one():
    judged = score(
        [hidden("mass", parameters={"scale": 1.2})],
        named(found("mass", None, {"scale": 1.1})),
        SPAN,
    )
    assert judged.errors["mass"] == pytest.approx(0.5)
    current = hidden("current", parameters={"north": 0.3, "east": 0.4})
    judged = score(
        [current],
        named(found("current", None, {"north": 0.3, "east": 0.35}, std=0.02, unit="m/s")),
        SPAN,
    )
    assert judged.errors["current"] == pytest.approx(0.1)
    assert judged.within == {"current north": True, "current east": False}


def test_an_estimate_in_another_unit_does_not_count():
    offset = hidden("azimuth_offset", "port", {"offset": 6.0})
    judged = score(
        [offset], named(found("azimuth_offset", "port", {"offset": 6.0}, unit="rad")), SPAN
    )
    assert (
        math.isnan(judged.errors["azimuth_offset port"])
        and not judged.within["azimuth_offset port offset"]
    )


@pytest.mark.parametrize(
    ("cause", "channels", "answered", "same"),
    [
        ("sign", ("sway",), ("sway",), True),
        ("sign", ("sway",), ("surge",), False),
        ("frame", ("wind_speed", "wind_from"), ("wind_from",), True),
        ("frame", ("wind_speed", "wind_from"), ("surge", "sway"), False),
        ("channel_swap", ("port_rpm", "starboard_rpm"), ("starboard_rpm", "port_rpm"), True),
        ("gap", ("north", "east"), ("time",), True),
    ],
)
def test_channels_belong_to_the_name_where_they_tell_faults_apart(cause, channels, answered, same):
    answer = named(found(cause, channels=answered, segments=[]))
    assert score([hidden(cause, channels=channels)], answer, SPAN).right == same


@pytest.mark.parametrize(
    ("segments", "answered", "located"),
    [
        ([(500, 560)], [(505, 561)], True),
        ([(500, 560)], [(540, 600)], False),
        ([(500, 560)], [], False),
        ([], [(10, 2390)], True),
        ([(14, 16), (90, 92)], [(13, 17), (89, 93)], True),
        ([(14, 16), (90, 92), (200, 202)], [(14, 16)], False),
    ],
)
def test_a_fault_is_located_where_at_least_half_of_all_time_is_common(segments, answered, located):
    judged = score([hidden("gap", segments=segments)], named(found("gap", segments=answered)), SPAN)
    assert judged.right and judged.located == located


def test_the_interval_of_a_rate_is_wilsons():
    # Newcombe (1998), Statistics in Medicine 17, 857-872, table I: 81 of 263, method 3
    assert tables.interval(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)


def test_a_run_that_was_cut_off_is_taken_up_where_it_was(tmp_path, monkeypatch):
    asked, totals = [], []

    def diagnosed(kind, name, seeds, **_):
        asked.extend(seeds)
        for seed in seeds:
            yield {"kind": kind, "set": name, "seed": seed}

    monkeypatch.setattr(runs, "diagnosed", diagnosed)
    into, quiet = (
        tmp_path / "results.jsonl",
        {"progress": lambda result, total: totals.append(total)},
    )
    runs.run(["hold"], ["healthy"], range(3), into, **quiet)
    into.write_text(into.read_text()[:-20])
    results = runs.run(["hold"], ["healthy"], range(4), into, **quiet)
    assert asked == [0, 1, 2, 2, 3] and totals == [3, 3, 3, 2, 2]
    assert [result["seed"] for result in results] == [0, 1, 2, 3]


def test_what_was_named_is_counted_by_how_sure_it_was():
    def answer(seed, *findings, **more):
        return {"answer": [hidden("mass")], "diagnosis": named(*findings), "seed": seed} | more

    sure, unsure = {"kind": "physics", "probability": 0.99}, {"kind": "physics", "probability": 0.7}
    fault = {"kind": "data", "probability": 1.0}
    results = [answer(i, found("mass", **sure)) for i in range(3)]
    results += [
        answer(3, found("tow", **sure), found("mass", **unsure)),
        answer(4, found("gap", **fault)),
    ]
    _, _, *lines = tables.calibration([*results, answer(5, diagnosis=None)])
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
    assert [row[:3] for row in cells] == [
        ["0.5 to 0.8", "1", "0.70"],
        ["0.95 to 1", "4", "0.99"],
        ["faults of the data", "1", "1.00"],
    ]
    assert [row[3].split()[0] for row in cells] == ["100.0", "75.0", "0.0"]


def test_removed_beyond_the_observer_is_of_what_it_leaves_and_right_answers_only():
    def answer(observer, after, floor, cause="mass", alone=1.0):
        gain = {
            "bias_observer_m": observer,
            "after_m": alone,
            "noise_floor_m": 0.5 * floor,
            "twin_m": 0.0,
        }
        gain |= {
            "after_observer_m": after,
            "twin_observer_m": floor,
            "before_m": 4.0,
            "network_m": 3.0,
        }
        gain["chance_worse"] = 0.99 if after > 1.2 * observer else 0.6
        diagnosis = named(found(cause)) | {"gain": gain, "drift": None}
        return {
            "kind": "work",
            "set": "drift",
            "answer": [hidden("mass")],
            "span": SPAN,
            "diagnosis": diagnosis,
        }

    results = [
        answer(2.0, 0.7, 0.7),
        answer(2.0, 0.96, 0.7),
        answer(2.0, 0.7, 0.7, "tow"),
        answer(0.7, 0.7, 0.69),
    ]
    rows = [row for row in tables.ROWS if row.name == "drift"]
    beside, noise, alone, worse, surely, needlessly, worse_alone, *shares = rows[: len(rows) // 2]
    cells = [tables.content(row, results, "work") for row in (beside, noise, alone)]
    assert cells == ["90 % (2)", "63 % (3)", "50 % (3)"]
    assert [tables.content(row, results, "work") for row in shares] == [
        "75 % (3)",
        "50 % (3)",
        "25 % (3)",
    ]
    assert not any(
        tables.content(row, results, "work") for row in rows[len(rows) // 2 :]
    )  # no drift
    assert tables.rates(results, "drift", "work", worse.hit) == (0, 4)
    assert tables.rates(results, "drift", "work", worse_alone.hit) == (1, 4)
    more = [answer(1.0, 1.1, 0.5), answer(1.0, 1.3, 0.5)]
    assert tables.rates(more, "drift", "work", worse.hit) == (2, 2)
    assert tables.rates(more, "drift", "work", surely.hit) == (1, 2)
    more += [answer(1.0, 1.3, 1.2)]
    assert [tables.rates(more, "drift", "work", row.hit) for row in (surely, needlessly)] == [
        (2, 3),
        (1, 3),
    ]


def test_after_the_manoeuvre_the_truth_must_be_named_or_in_the_set():
    set_of_two = {
        "verdict": "ambiguous",
        "findings": [],
        "indistinguishable": [found("mass"), found("tow")],
    }
    (row,) = (
        row
        for row in tables.ROWS
        if row.label == "in the reported set after the one prescribed manoeuvre"
    )
    answers = (named(found("mass")), set_of_two, named(found("drag")), HEALTHY)
    results = [
        {
            "kind": "hold",
            "set": "one sailed",
            "answer": [hidden("mass")],
            "span": SPAN,
            "diagnosis": answer,
        }
        for answer in answers
    ]
    assert tables.rates(results, row.name, "hold", row.hit) == (2, 4)


def test_a_poor_log_may_be_refused_but_not_crash_nor_get_a_wrong_name():
    base = {
        "kind": "work",
        "set": "brief_45s",
        "answer": [hidden("mass")],
        "span": SPAN,
        "seconds": 1.0,
        "version": "-",
    }
    refused = base | {"seed": 1, "diagnosis": None, "error": "ShipcosimError: 45 rows over 44 s."}
    crashed = base | {"seed": 2, "diagnosis": None, "error": "ValueError: zero-size array"}
    wrong = base | {"seed": 3, "diagnosis": named(found("tow")), "error": None}
    rows = {row.label: row for row in tables.ROWS}
    counts = [
        tables.rates([refused, crashed, wrong], "brief_45s", "work", rows[f"brief 45s: {what}"].hit)
        for what in ("refused", "a crash", "a wrong name")
    ]
    assert counts == [(1, 3)] * 3
