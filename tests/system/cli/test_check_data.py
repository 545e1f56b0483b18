"""`shipcosim check` of measured data: what is ordinary is a remark, a fault of the data an error."""

import numpy as np
import pytest

from shipcosim.checks import check_any

T = np.arange(300.0)


def written(folder, header, **columns):
    path = folder / "log.csv"
    np.savetxt(
        path,
        np.column_stack(list(columns.values())),
        delimiter=",",
        header=header,
        comments="",
        fmt="%.6f",
    )
    return path


def noise(seed):
    return np.random.default_rng(seed).normal(size=len(T))


@pytest.fixture
def held(tmp_path):
    """A log with two rows in the wrong order and a minute of held values."""
    time = T.copy()
    time[[5, 6]] = time[[6, 5]]
    surge = 1.0 + 0.1 * noise(1)
    surge[100:160] = surge[100]
    return written(tmp_path, "t,u", t=time, u=surge)


def test_faults_of_a_log_are_errors_and_its_order_a_remark(held, tmp_path):
    (tmp_path / "channels.toml").write_text('time = "t"\nsurge = "u"\n')
    problems = check_any(str(held), tmp_path / "channels.toml")
    assert [problem.severity for problem in problems] == ["remark", "error"]
    assert "sorted by time" in problems[0].found
    assert (
        "gap: values are held, 101 to 159 s" in problems[1].found and "surge" in problems[1].where
    )


def test_a_table_named_by_roles_is_examined_without_a_channel_file(tmp_path):
    path = written(tmp_path, "time [s],surge [kn]", time=T, surge=1.0 + 0.1 * noise(2))
    assert check_any(str(path)) == []


def test_a_log_that_cannot_be_read_says_why(held, tmp_path):
    (tmp_path / "channels.toml").write_text('time = "t"\nsurge = "uu"\n')
    problems = check_any(str(held), tmp_path / "channels.toml")
    assert len(problems) == 1 and "there is no column 'uu'" in problems[0].found


def test_a_table_without_navigation_is_only_a_table(tmp_path):
    path = written(tmp_path, "time [s],level [m]", time=T[::-1], level=T)
    problems = check_any(str(path))
    assert [problem.severity for problem in problems] == ["error"] and "follows" in problems[
        0
    ].found
