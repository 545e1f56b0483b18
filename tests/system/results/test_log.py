"""A measured log as Python gives it back."""

import numpy as np
import pytest

import shipcosim as sc


@pytest.fixture(scope="module")
def log():
    return sc.read_log("gunnerus_log")


def test_a_log_reads_like_its_table(log):
    assert log["heading"].attrs["units"] == "deg" and log.sizes["time"] == len(log.to_pandas())
    assert (
        "heading" in log
        and list(log) == list(log.table)
        and "Log 'gunnerus_log.csv.gz'" in repr(log)
    )


@pytest.mark.parametrize("call", [sc.diagnose, sc.calibrate])
def test_bytes_are_no_log_and_no_list_of_logs(call):
    with pytest.raises(sc.ShipcosimError, match="b'log' is neither a path nor a name"):
        call(b"log")


def test_the_card_lists_channels_and_faults(log):
    card = log._repr_html_()
    assert "Channels" in card and "heading" in card and "data:image/svg+xml" in card
    assert log.faults == () and "LOG" in card


def test_a_fault_that_the_channels_show_is_said(log):
    table = log.table.copy(deep=True)
    table["heading"][200:400] = np.nan
    broken = sc.read_log(table)
    assert broken.faults and "FAULTY" in broken._repr_html_()


def test_columns_that_are_not_used_are_said(tmp_path):
    rows = "".join(f"{k},{k},0,90,1,x\n" for k in range(60))
    (tmp_path / "odd.csv").write_text(
        f"time,north,east,heading,surge,foo\n{rows}", encoding="utf-8"
    )
    log = sc.read_log(tmp_path / "odd.csv")
    assert any("foo" in remark for remark in log.remarks) and "foo" in log._repr_html_()


def test_channels_are_drawn_by_name_and_pattern(log):
    assert "heading" in log.plot("heading").svg
    assert "measured" in log.track().svg
    with pytest.raises(sc.ShipcosimError, match="Did you mean 'heading'"):
        log.plot("headin")


def test_a_log_without_a_position_has_no_track(log):
    with pytest.raises(sc.ShipcosimError, match="The log has no position"):
        sc.read_log(log.table.drop_vars(["north", "east"])).track()


def test_a_log_that_is_not_there_is_said_with_the_examples():
    with pytest.raises(sc.ShipcosimError, match="There is: gunnerus_log"):
        sc.read_log("gunnerus_lgo")
