"""Tables that tools of ships export open with the right channels; a doubt is asked, and no channel is wrong."""

import json

import numpy as np
import pytest
from diagnose.log.exports import COUNT, SHIP, TABLES, _plain, motion, table, texts_of

from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of
from shipcosim.diagnose.log.values import values_of

TURNS = ("heading", "course_over_ground", "wind_from", "true_wind_from", "azimuth")


def wrong_channels(path, expected, asked):
    """What is wrong of a file's channels: silently wrong ones, and those that are missing or not asked."""
    log = columns_of(path)
    truth = motion()
    proposal = propose(log, SHIP)
    sure = proposal.channels()
    proposed = {guess.role for guess in proposal.used}
    wrong = [
        f"{role} from '{sure[role].column}' in silence" for role in sorted(set(sure) - expected)
    ]
    wrong += [f"{role} is missing" for role in sorted(expected - proposed)]
    wrong += [
        f"{role} is asked, and could be sure" for role in sorted(expected & proposed - set(sure))
    ]
    wrong += [f"{role} is not even asked" for role in sorted(asked - proposed)]
    for role in sorted(set(sure) & expected - {"time"}):
        off = values_of(sure[role], role, log, FileLayout())[0] - truth[role]
        off = (off + 180.0) % 360.0 - 180.0 if role.endswith(TURNS) else off
        if np.abs(off).max() > 1e-3:
            wrong.append(f"{role} is off by {np.abs(off).max():.3g}")
    return wrong


@pytest.mark.parametrize("encoding", ["cp932", "euc_jp", "utf-16"])
def test_japanese_is_read_in_its_encodings(encoding, tmp_path):
    columns = _plain(TABLES["Japanese"][0])
    path = tmp_path / "log.csv"
    path.write_text(table(columns), encoding=encoding)
    assert wrong_channels(path, {role for *_, role in columns}, set()) == []


@pytest.mark.parametrize("kind", TABLES)
def test_an_exported_table_has_its_channels(kind, tmp_path):
    columns, form = TABLES[kind]
    columns = _plain(columns)
    path = tmp_path / "log.csv"
    path.write_text(table(columns, **form), encoding="utf-8")
    roles = {column[2] for column in columns if len(column) > 2 and column[2]}
    asked = {role.removeprefix("?") for role in roles if role.startswith("?")}
    expected = {role for role in roles if not role.startswith("?")}
    assert wrong_channels(path, expected, asked - expected) == []


CHANNELS = ("latitude", "longitude", "heading", "yaw_rate", "port_rpm")


def lines_of(form):
    """A long table of the motion: one value a row, by the names that databases give to the columns."""
    truth = motion()
    for row, stamp in enumerate(texts_of("iso")):
        for number, name in enumerate(CHANNELS):
            yield form.format(t=stamp, n=name, v=truth[name][row], k=number)


@pytest.mark.parametrize(
    "head, form",
    [
        ("time,vessel_id,parameter_id,value", "{t},ferry,{n},{v}"),
        ("time,tag_name,value", "{t},{n},{v}"),
        (
            "#datatype,string,long,dateTime:RFC3339,double,string,string\n"
            "#default,_result,,,,,\n,result,table,_time,_value,_field,_measurement",
            ",,{k},{t},{v},{n},ship",
        ),
    ],
)
def test_a_table_of_a_database_with_one_value_a_row_has_its_channels(head, form, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("\n".join([head, *lines_of(form)]) + "\n", encoding="utf-8")
    assert wrong_channels(path, {"time", *CHANNELS}, set()) == []


def deltas():
    """The motion as deltas of Signal K."""
    truth = motion()
    for row, stamp in enumerate(texts_of("iso")):
        place = {name: truth[name][row] for name in ("latitude", "longitude")}
        values = [
            {"path": "navigation.position", "value": place},
            {"path": "navigation.headingTrue", "value": np.radians(truth["heading"][row])},
        ]
        updates = [{"source": {"label": "n2k"}, "timestamp": stamp, "values": values}]
        yield json.dumps({"context": "vessels.self", "updates": updates})


@pytest.mark.parametrize("is_list", [False, True])
def test_deltas_of_signal_k_are_read(is_list, tmp_path):
    path = tmp_path / "log.json"
    text = f"[{','.join(deltas())}]" if is_list else "\n".join(deltas())
    path.write_text(text, encoding="utf-8")
    assert wrong_channels(path, {"time", "latitude", "longitude", "heading"}, set()) == []


@pytest.mark.parametrize("label", ["label", "path", "source", "type", "message"])
def test_a_text_in_each_row_of_a_wide_table_is_a_label_and_names_no_channel(label, tmp_path):
    """Beside a position y it was taken for the name of a channel, and y for its value."""
    columns = [("time [s]", "time"), ("x [m]", "north"), ("y [m]", "east"), ("heading", "heading")]
    head, *rows = table([*columns, ("port_rpm", "port_rpm")]).splitlines()
    lines = [f"{row},{'transit' if k < COUNT // 2 else 'hold'}" for k, row in enumerate(rows)]
    path = tmp_path / "log.csv"
    path.write_text("\n".join([f"{head},{label}", *lines]) + "\n", encoding="utf-8")
    assert wrong_channels(path, {"time", "heading", "port_rpm"}, {"north", "east"}) == []
