"""The neural allocator of paper V: what the law adds to the network."""

from pathlib import Path

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.allocation import paper_v, pseudo_inverse
from shipcosim.models.core.networks import empty_memory, evaluate, read_arrays

UNITS = parameters(paper_v.PaperVParameters, "thesis-28m9")
WEIGHTS = Path(__file__).parents[4] / "fmus" / "paper_v_allocator" / "weights"
ALL, TAU = (True, True, True), (1500.0, -2500.0, 8e3)


@pytest.fixture(scope="module")
def design():
    return paper_v.design(read_arrays(WEIGHTS / "paper-v.npz"))


def after(seconds, design, h=0.5, tau=TAU, available=ALL, shares=(1.0, 1.0, 1.0)):
    """State after some seconds with one request."""
    state = paper_v.at_rest(tau, parameters=UNITS)
    for _ in range(round(seconds / h)):
        state = paper_v.step(
            state, tau, available, h, parameters=UNITS, design=design, shares=shares
        )
    return state


def test_commands_are_outputs_of_the_network_sample_by_sample(design):
    memory = empty_memory(design.encoder)
    for _ in range(20):
        found, memory = evaluate(design.encoder, (np.array(TAU) - design.mean) / design.std, memory)
    state = after(20.0, design)
    tunnel, port, a, starboard, b = found * design.ranges
    assert (*state.thrusts, *state.azimuths[:2]) == pytest.approx(
        (port, starboard, tunnel, a, b), rel=1e-12
    )
    assert len(state.memory) == 2 and state.memory[0].cell.shape == memory[0].cell.shape


def test_the_step_of_the_master_does_not_count(design):
    assert after(20.0, design, h=0.05).commands == after(20.0, design, h=1.0).commands


def test_the_load_is_that_of_the_full_configuration_matrix(design):
    state = after(20.0, design)
    fields = pseudo_inverse.AllocationParameters.__dataclass_fields__
    known = {name: getattr(UNITS, name) for name in fields if hasattr(UNITS, name)}
    known |= {"port_azimuth": state.azimuths[0], "starboard_azimuth": state.azimuths[1]}
    b = pseudo_inverse.effect(
        pseudo_inverse.AllocationParameters(azimuth_weight=1.0, tunnel_weight=1.0, **known)
    )
    assert (state.tau_X, state.tau_Y, state.tau_N) == pytest.approx(
        pseudo_inverse.load(state.thrusts, b), rel=1e-9
    )


def test_a_request_it_was_trained_on_is_met_roughly(design):
    """Not tuned: a tenth of the standard deviation of its training data."""
    rng = np.random.default_rng(11)
    drawn = rng.uniform(-1.0, 1.0, (50, 3)) * 0.8 * design.std
    errors = [np.array(after(20.0, design, 1.0, tuple(tau))[2:5]) - tau for tau in drawn]
    assert (np.abs(errors).mean(0) < 0.1 * design.std).all()


def test_a_missing_unit_gives_nothing_and_the_others_do_not_take_over(design):
    whole, part = after(20.0, design), after(20.0, design, available=(False, True, True))
    assert part.thrusts == (0.0, *whole.thrusts[1:])
    assert part.saturated and not whole.saturated


def test_a_lack_of_power_limits_the_thrust(design):
    share = 0.01
    part = after(20.0, design, shares=(share,) * 3)
    limits = (
        share * UNITS.azimuth_thrust_max,
        share * UNITS.azimuth_thrust_max,
        share * UNITS.tunnel_thrust_max,
    )
    assert (
        all(abs(f) <= limit for f, limit in zip(part.thrusts, limits, strict=True))
        and part.saturated
    )


@pytest.mark.parametrize("variant", sorted(file.stem for file in WEIGHTS.glob("*.npz")))
def test_the_azimuths_push_against_each_other_where_nothing_is_asked_for(variant):
    """Why it saves no power (docs/reports/allocation.md): each gives more than 1.5 kN, together next to nothing."""
    state = after(
        60.0, paper_v.design(read_arrays(WEIGHTS / f"{variant}.npz")), 1.0, (0.0, 0.0, 0.0)
    )
    assert min(abs(f) for f in state.thrusts[:2]) > 1500.0
    assert abs(state.tau_X) < 300.0 and abs(state.tau_Y) < 300.0
