"""At night: naming the cause is worth more than a bias observer, under DP and in the drift after it."""

from trial import runs, tools


def test_naming_the_cause_is_worth_more_than_a_bias_observer_under_dp_and_in_the_drift_after_it(
    tmp_path,
):
    (case,) = runs.draw_many("trial", [3], among=["current"], after=runs.DRIFT)
    case.save(tmp_path / "log.csv")
    case.twin().save(tools.twin_of(tmp_path / "log.csv"))
    found = tools.with_drift(tmp_path / "log.csv").as_json()
    for gain in (found["gain"], found["drift"]):
        assert gain["noise_floor_m"] <= gain["after_m"] < 0.5 * gain["bias_observer_m"]
        assert gain["twin_m"] < 0.5 * gain["bias_observer_m"]
    assert found["drift"]["segments"] > 30
