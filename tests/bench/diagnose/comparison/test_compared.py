"""At night: the comparison with craft of other seeds than in CI."""

from diagnose.comparison.test_compared import check_healthy, check_unknown_weather


def test_nothing_is_said_of_another_healthy_craft():
    check_healthy(12)


def test_thrusters_that_answer_other_weather_are_not_said_to_run_the_wrong_way(tmp_path):
    check_unknown_weather(704, tmp_path)
