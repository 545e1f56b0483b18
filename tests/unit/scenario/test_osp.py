"""Scenario files of OSP: times, values and mistakes as libcosim's reader takes them."""

import pytest
from osp_events import DEFAULTS, EVENTS, written

from shipcosim.errors import ShipcosimError
from shipcosim.scenario.osp import read_osp_scenario, write_osp_scenario


def test_times_count_from_the_start_of_the_run_and_move_up_to_a_step(tmp_path):
    file = written(
        tmp_path / "events.json", events=EVENTS[3:4] + EVENTS[:1], defaults=DEFAULTS, end=0.6
    )
    read = read_osp_scenario(file, 0.05, 12.0, start_time=10.0)
    assert [round(event.time, 9) for event in read.events] == [10.45, 10.1, 10.6, 10.6]
    assert [event.changes[0][:2] for event in read.events[2:]] == [
        ("reset", "plant.y"),
        ("reset", "law.u"),
    ]


def test_yaml_takes_numbers_and_truths_as_libcosims_reader_does(tmp_path):
    file = tmp_path / "events.yaml"
    file.write_text(
        "events:\n"
        "- {time: 0, model: a, variable: x, action: override, value: 1e5}\n"
        "- {time: 0, model: a, variable: b, action: override, value: true}\n"
        "- {time: '0.5', model: a, variable: n, action: override, value: '7'}\n"
        "end: 9\n"
    )
    values = [event.changes[0][2] for event in read_osp_scenario(file, 0.5, 2.0).events]
    assert values == [1e5, True, 7] and [type(value) for value in values] == [float, bool, int]


def test_what_is_written_is_read_back(tmp_path):
    events = [EVENTS[0], EVENTS[1], EVENTS[4]]
    for name in ("a.json", "a.yaml"):
        write_osp_scenario(tmp_path / name, "Größe", events, 1e3)
        read = read_osp_scenario(tmp_path / name, 0.05, 1.0)
        assert read.description == "Größe" and read.remarks == []
        changes = [(event.time, *event.changes[0]) for event in read.events]
        wanted = [
            (e["time"], e["action"], f"{e['model']}.{e['variable']}", e["value"]) for e in events
        ]
        assert changes == wanted


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("[1, 2]", "It holds no object at its top."),
        ("{", "cannot be read as JSON"),
        ('{"events": [], "events": []}', "'events' is there twice"),
        ('{"events": 3}', "'events' a list"),
        ('{"events": [3]}', "event 1: An event has to be an object."),
        ('{"events": [{}]}', "event 1: It has no time."),
        ('{"events": [{"time": "soon"}]}', "time is 'soon'. Give it in seconds."),
        (
            '{"events": [{"time": 1, "variable": "b", "action": "reset"}]}',
            "It has no model, and the defaults have none.",
        ),
        (
            '{"events": [{"time": 1, "model": "a", "variable": "b", "action": "overide", "value": 1}]}',
            "The action 'overide' is not known. There is: bias, override, reset. Did you mean 'override'?",
        ),
        (
            '{"events": [{"time": 1, "model": "a", "variable": "b", "action": "override"}]}',
            "It has no value.",
        ),
        (
            '{"events": [{"time": 1, "model": "a", "variable": "b", "action": "override", "value": NaN}]}',
            "nan is no usable number.",
        ),
        (
            '{"events": [{"time": 1, "model": "a", "variable": "b", "action": "bias", "value": true}]}',
            "A bias of True.",
        ),
    ],
)
def test_a_faulty_file_is_refused_with_its_place(tmp_path, content, message):
    file = tmp_path / "events.json"
    file.write_text(content)
    with pytest.raises(ShipcosimError) as error:
        read_osp_scenario(file, 0.1, 1.0)
    assert message in str(error.value) and str(file) in str(error.value)


def test_aliases_of_yaml_are_refused(tmp_path):
    file = tmp_path / "events.yml"
    file.write_text("a: &a [1]\nevents: [*a, *a]\n")
    with pytest.raises(ShipcosimError, match="alias"):
        read_osp_scenario(file, 0.1, 1.0)


def test_two_changes_of_a_signal_in_one_step_and_unknown_keys_are_remarked(tmp_path):
    events = [EVENTS[0], EVENTS[0] | {"value": 3.0, "comment": "later"}]
    read = read_osp_scenario(written(tmp_path / "events.json", events=events, end=1.0), 0.05, 1.0)
    text = "\n".join(map(str, read.remarks))
    assert (
        "event 2: 'comment' is not used." in text
        and "law.u is changed twice in the step at 0.1 s" in text
    )
