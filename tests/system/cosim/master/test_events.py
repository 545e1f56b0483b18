"""Events act on the step that starts at their time, as in OSP. test_libcosim compares them with libcosim itself."""

import numpy as np
import pytest

from shipcosim.cosim import simulate
from shipcosim.errors import ShipcosimError


@pytest.fixture
def seen(make_system, make_scenario):
    """Function: ``lag -> gain`` with events, ten steps of 0.1 s; values of a signal."""

    def run(signal, *events, connectors=None):
        links = ["integrator.y -> gain.u", *(["rate -> integrator.u"] if connectors else [])]
        start = {} if connectors else {"u": 1.0}
        system = make_system(
            {"integrator": ("integrator", start), "gain": "gain"}, links, connectors
        )
        scenario = make_scenario(
            1.0, 0.1, events=list(events), set={"rate": 1.0} if connectors else {}
        )
        return simulate(system, scenario)[signal].values

    return run


K = np.arange(11)


def test_overridden_input_ignores_its_connection_from_the_step_of_the_event(seen):
    values = seen("gain.y", {"time": 0.4, "override": {"gain.u": -7.0}})
    assert np.allclose(values[:5], np.maximum(K - 1, 0)[:5] * 0.1) and np.all(values[5:] == -7.0)


def test_overridden_output_is_what_others_see(seen):
    event = {"time": 0.4, "override": {"integrator.y": -7.0}}
    assert np.allclose(seen("integrator.y", event)[:5], 0.1 * K[:5]) and np.all(
        seen("integrator.y", event)[5:] == -7.0
    )
    assert np.all(seen("gain.y", event)[6:] == -7.0) and seen("gain.y", event)[5] == pytest.approx(
        0.4
    )


def test_bias_adds_and_reset_restores(seen):
    events = {"time": 0.2, "bias": {"gain.u": 10.0}}, {"time": 0.5, "reset": ["gain.u"]}
    plain = np.maximum(K - 1, 0) * 0.1
    assert np.allclose(seen("gain.y", *events), plain + np.where((K >= 3) & (K <= 5), 10.0, 0.0))


def test_a_second_change_replaces_the_first(seen):
    values = seen(
        "gain.y", {"time": 0.2, "override": {"gain.u": 5.0}}, {"time": 0.4, "bias": {"gain.u": 1.0}}
    )
    assert np.all(values[3:5] == 5.0) and np.allclose(values[5:], (K[5:] - 1) * 0.1 + 1.0)


def test_unconnected_input_shows_its_new_value_in_the_row_of_the_event(seen):
    events = (
        {"time": 0.0, "override": {"integrator.u": 2.0}},
        {"time": 0.3, "reset": "integrator.u"},
    )
    assert seen("integrator.u", *events).tolist() == [2.0] * 3 + [1.0] * 8
    assert np.allclose(
        seen("integrator.y", *events), np.minimum(K, 3) * 0.2 + np.maximum(K - 3, 0) * 0.1
    )


def test_connector_of_the_system_changes_for_all_behind_it(seen):
    connectors = {"rate": ("input", "Real", "")}
    events = (
        {"time": 0.2, "bias": {"rate": 1.0}},
        {"time": 0.4, "override": {"rate": -1.0}},
        {"time": 0.6, "reset": ["rate"]},
    )
    rates = [1.0, 1.0, 2.0, 2.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    assert seen("rate", *events, connectors=connectors).tolist() == rates
    assert np.allclose(
        seen("integrator.y", *events, connectors=connectors), np.cumsum([0.0, *rates[:-1]]) * 0.1
    )


def test_flags_and_whole_numbers_change_too(make_system, make_scenario):
    events = [
        {"time": 0.2, "override": {"meter.flag": True, "meter.number": 3}},
        {"time": 0.4, "reset": ["meter.flag"]},
    ]
    table = simulate(make_system({"meter": "meter"}), make_scenario(0.6, 0.1, events=events))
    assert table["meter.flag"].values.tolist() == [False, False, True, True, False, False, False]
    assert table["meter.y"].values.tolist() == [7.0, 7.0, 7.0, 1003.0, 1003.0, 3.0, 3.0]


def test_events_on_a_slow_component_act_on_its_next_step(make_system, make_scenario):
    system = make_system({"slow": ("integrator", {"u": 1.0}, 0.4)})
    table = simulate(
        system, make_scenario(1.2, 0.1, events=[{"time": 0.1, "override": {"slow.u": 0.0}}])
    )
    assert np.allclose(table["slow.y"].values, [0.0] * 4 + [0.4] * 9)


@pytest.mark.parametrize(
    ("event", "said"),
    [
        (
            {"time": 0.25, "override": {"gain.u": 1.0}},
            "0.25 s is no multiple of the step size 0.1 s",
        ),
        ({"time": 0.2, "override": {"gian.u": 1.0}}, "Did you mean 'gain'"),
        ({"time": 0.2, "override": {"gain.v": 1.0}}, "gain has no variable 'v'"),
        ({"time": 0.2, "override": {"gain.offset": 1.0}}, "'gain.offset' is a fixed parameter"),
        (
            {"time": 0.2, "override": {"gain.u": True}},
            "with True: the signal is Real. A number is needed",
        ),
        (
            {"time": 0.2, "override": {"meter.flag": 1.0}},
            "the signal is Boolean. Override it with true or false",
        ),
        ({"time": 0.2, "override": {"meter.number": 1.5}}, "the signal is Integer. A whole number"),
        (
            {"time": 0.2, "override": {"meter.number": 2**31}},
            "too large for an Integer. Give one from",
        ),
        (
            {"time": 0.2, "override": {"meter.number": -1e12}},
            "too large for an Integer. Give one from",
        ),
        ({"time": 0.2, "bias": {"meter.flag": 1.0}}, "bias of 'meter.flag'"),
        (
            {"time": 0.2, "override": {"meter.text": "a"}},
            "the signal is String. It cannot be changed",
        ),
    ],
)
def test_events_that_do_not_fit_are_refused(make_system, make_scenario, event, said):
    with pytest.raises(ShipcosimError, match=said):
        simulate(
            make_system({"gain": "gain", "meter": "meter"}), make_scenario(1.0, 0.1, events=[event])
        )
