"""What of a log is used, what is not and why is always said; what can be read in two ways is refused with both."""

import sys

import numpy as np
import pytest
from diagnose.log.oddities import THRUSTERS, save

from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of, read_log
from shipcosim.errors import ShipcosimError

MAP = 'time = "time"\nsurge = {column = "p", map = [[1000, -2], [1500, 0], [2000, 4]]}'
ROWS = [f"{i},{0.1 * i:.1f}" for i in range(20)]


def remarks(folder, text, thrusters=THRUSTERS):
    return " ".join(read_log(save(folder, text), None, thrusters).attrs["column_remarks"])


def why(folder, text, column):
    proposal = propose(columns_of(save(folder, text)), THRUSTERS)
    return next(guess.why for guess in (*proposal.unused, *proposal.used) if guess.column == column)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "time;surge\n0;1,234\n1;2,345\n",
            r"'1,234' can be 1.234 \(decimal comma\) or 1234 \(thousands\)",
        ),
        ("time;surge;sway\n0;1,5;2.345\n1;2,5;3.456\n", "'2.345' can be 2.345 or 2345"),
        (
            "time,surge\n03/04/2022 08:00:00,1\n04/05/2022 08:00:00,2\n",
            "day/month/year .* or month/day/year",
        ),
        ("time,surge\n08:01,1\n08:02,2\n08:03,2\n", "hours and minutes or minutes and seconds"),
        (
            "time,surge\n0,1,5\n1,2,5\n2,3,5\n",
            "line 2: has 3 cells, and the header has 2. Are these decimal commas",
        ),
        ("0,1,2\n1,1,2\n2,1,2\n", "no names of columns stand above .* file = {names"),
        (
            'time,surge,note\n0,1,a\n1,1,"b\n2,1,c\n3,2,d"\n4,2,e\n',
            "a quotation mark is opened in a row",
        ),
        (
            "time,lat,lon\n0,94.2,10\n1,94.3,10\n2,94.4,10\n",
            "latitude: is 94.2 in row 2, beyond 90 deg",
        ),
        ("time,heading,heading\n0,1,2\n1,1,2\n", "column 'heading': is there twice"),
    ],
)
def test_what_can_be_read_in_two_ways_or_in_none_is_refused(tmp_path, text, said):
    with pytest.raises(ShipcosimError, match=said):
        read_log(save(tmp_path, text))


@pytest.mark.parametrize(
    ("entry", "text", "surge"),
    [
        ('file = {decimal = ","}', "time;surge\n0;1,234\n1;2,345\n", [1.234, 2.345]),
        ('file = {decimal = "."}', "time;surge\n0;1,234\n1;2,345\n", [1234.0, 2345.0]),
        ('file = {names = ["time", "surge"]}', "0 1\n1 2\n", [1.0, 2.0]),
        (
            'time = "time"\nsurge = {column = "p", map = [[1000, -2], [1500, 0], [2000, 4]]}',
            "time,p\n0,1250\n1,2000\n",
            [-1, 4],
        ),
        (
            'file = {decimal = "."}\ntime = "t"\nsurge = "u (m/s)"',
            "t,u (m/s)\n0,1\n1,2\n",
            [1.0, 2.0],
        ),
    ],
)
def test_a_channel_file_says_what_the_log_leaves_open(tmp_path, entry, text, surge):
    channels = save(tmp_path, entry, "channels.toml")
    assert read_log(save(tmp_path, text), channels)["surge"].values == pytest.approx(surge)


@pytest.mark.parametrize(("order", "days"), [("dmy", 33), ("mdy", 93), ("", 0)])
def test_dates_are_read_in_the_order_that_is_said(tmp_path, order, days):
    path = save(tmp_path, "time,surge\n03/04/2022 08:00:00,1\n06/05/2022 08:00:00,2\n")
    channels = save(tmp_path, f'file = {{dates = "{order}"}}', "channels.toml") if order else None
    if order:  # 3 April to 6 May, or 4 March to 5 June
        assert read_log(path, channels)["time"].values[-1] == days * 86400
    else:
        with pytest.raises(ShipcosimError, match="lasting"):
            read_log(path)


def test_a_column_of_a_thruster_is_matched_or_the_thrusters_are_listed(tmp_path):
    text = ["time,surge,stbd_rpm,stern_rpm", *(f"{row},3,4" for row in ROWS)]
    said = remarks(tmp_path, text)
    assert "starboard_rpm from 'stbd_rpm'" in said
    assert (
        "'stern_rpm': no thruster of the system is meant by it: there is port, starboard, tunnel"
        in said
    )


def test_without_thrusters_that_a_log_can_name_a_channel_file_is_the_way(tmp_path):
    """As of a ship whose thrusters are all measured maps, over any command."""
    said = remarks(
        tmp_path, ["time,surge,left_command", *(f"{row},3" for row in ROWS)], thrusters={}
    )
    assert (
        "the system has no thruster that it can be; a channel file can name an input of the system"
        in said
    )


def test_pulses_and_per_cent_are_said_with_what_to_write(tmp_path):
    text = ["time,surge,port_pwm,stbd load [%]", *(f"{row},1500,4" for row in ROWS)]
    assert 'port_rpm = {column = "port_pwm", map = [[1100, A], [1500, 0], [1900, B]]}' in why(
        tmp_path, text, "port_pwm"
    )


def test_a_command_beside_feedback_and_one_alone_are_said(tmp_path):
    text = ["time,surge,port_rpm_cmd,port_rpm_fb,stbd_rpm_cmd", *(f"{row},5,6,7" for row in ROWS)]
    said = remarks(tmp_path, text)
    assert (
        "the command beside it, 'port_rpm_cmd', is not used" in said
        and "a command; there is no feedback" in said
    )
    log = read_log(save(tmp_path, text), None, THRUSTERS)
    assert (log["port_rpm"].values == 6).all() and (log["starboard_rpm"].values == 7).all()


def test_rows_beyond_the_earth_columns_without_a_value_and_damaged_cells_are_said(tmp_path):
    rows = [f"{i},{59 + 1e-5 * i:.6f},10.0,,{0.1 * i:.1f}" for i in range(300)]
    rows[7] = "7,159.0,10.0,,0.7"
    rows[9] = "9,59.00009,10.0,,0.x9"
    rows[11] = "11,0,0,,1.1"
    said = remarks(tmp_path, ["time,lat,lon,heading,surge", *rows])
    for part in (
        "1 row with a position beyond the earth",
        "heading: no row has a value",
        "the first '0.x9' in row 11",
    ):
        assert part in said
    assert "0, 0, which is no fix" in said


def test_a_unit_of_something_else_is_no_role(tmp_path):
    text = ["time,surge,Yaw Rate [m/s]", *(f"{row},1" for row in ROWS)]
    assert "its unit 'm/s' is none of yaw_rate" in why(tmp_path, text, "Yaw Rate")


def test_speed_over_ground_without_a_unit_is_a_guess_where_positions_do_not_tell(tmp_path):
    text = ["time,heading,SOG,COG", *(f"{row},3,200" for row in ROWS)]
    assert "kn or m/s" in why(tmp_path, text, "SOG")


def test_excel_without_openpyxl_is_one_clear_error(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    path = tmp_path / "log.xlsx"
    path.write_bytes(b"PK")
    with pytest.raises(ShipcosimError, match=r"pip install shipcosim\[excel\]"):
        read_log(path)


def test_no_cell_is_lost_where_numbers_are_long(tmp_path):
    values = np.random.default_rng(2).normal(size=50)
    text = ["time,surge", *(f"{i},{value!r}" for i, value in enumerate(values.tolist()))]
    assert read_log(save(tmp_path, text))["surge"].values.tolist() == values.tolist()
