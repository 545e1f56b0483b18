"""State events of model exchange, held against closed forms over all directions, levels, rates and steps."""

from functools import cache

import c_fmus
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcosim.cosim import RunError, simulate
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component, System, read_fmu

VERSIONS = ("1.0", "2.0", "3.0")
UNUSED = "static int completed(M* m) { return 0; }\n"
# In each model r[0] is the first state and i[0] a discrete state that the test reads.
SOURCES = {
    # On below r[3], off above r[2]; warms by r[4], cools by r[5].
    "thermostat": """
#define NX 1
#define NZ 2
#define STATES {0}
static void start(M* m) { m->i[0] = 1; }
static void equations(M* m) { m->r[1] = m->i[0] ? m->r[4] : -m->r[5]; }
static void indicators(M* m, double* z) { z[0] = m->r[0] - m->r[2]; z[1] = m->r[0] - m->r[3]; }
static void event(M* m) {
  if (m->r[0] > m->r[2]) m->i[0] = 0;
  if (m->r[0] < m->r[3]) m->i[0] = 1;
}
""",
    # A line of slope r[2] through 0; i[k] is 1 once it has passed r[3] by the comparison k.
    "levels": """
#define NX 1
#define NZ 1
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = m->r[2]; }
static void indicators(M* m, double* z) { z[0] = m->r[4] * (m->r[0] - m->r[3]); }
static void event(M* m) {
  double x = m->r[0], a = m->r[3];
  m->i[0] = x > a; m->i[1] = x >= a; m->i[2] = x < a; m->i[3] = x <= a;
}
""",
    # Two levels r[3] and r[4] of one line of slope r[2], each counted where it is passed.
    "pair": """
#define NX 1
#define NZ 2
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = m->r[2]; }
static void indicators(M* m, double* z) { z[0] = m->r[0] - m->r[3]; z[1] = m->r[4] - m->r[0]; }
static void event(M* m) { m->i[0] = m->r[0] > m->r[3]; m->i[1] = m->r[0] > m->r[4]; }
""",
    # x goes with the time; two windows of it, each entered and left: i[0], i[1] count how often that was seen.
    "windows": """
#define NX 1
#define NZ 3
#define STATES {0}
static double window(M* m, double middle) { return m->r[2] * m->r[2] - pow(m->r[0] - middle, 2); }
static void start(M* m) {}
static void equations(M* m) { m->r[1] = 1; }
static void indicators(M* m, double* z) {
  z[0] = window(m, m->r[3]); z[1] = -window(m, m->r[4]); z[2] = m->r[0] - m->r[5];
}
static void event(M* m) {
  for (int k = 0; k < 2; k++) {
    int inside = window(m, m->r[3 + k]) > 0;
    if (inside != m->i[4 + k]) m->i[k]++;
    m->i[4 + k] = inside;
  }
  m->i[2] = m->r[0] > m->r[5];
}
""",
    # A block under a force r[4] + r[5] t: it sticks up to a force of 2 and slides against one of 1. i[0] is its direction.
    "block": """
#define NX 2
#define NZ 3
#define STATES {0, 1}
static double force(M* m) { return m->r[4] + m->r[5] * m->time; }
static void start(M* m) {}
static void equations(M* m) {
  m->r[2] = m->i[0] ? m->r[1] : 0;
  m->r[3] = m->i[0] ? force(m) - m->i[0] : 0;
}
static void indicators(M* m, double* z) {
  z[0] = force(m) - 2; z[1] = force(m) + 2; z[2] = m->i[0] ? m->r[1] : 1;
}
static void event(M* m) {
  if (m->i[0] && m->i[0] * m->r[1] < 0) { m->i[0] = 0; m->r[1] = 0; }
  if (!m->i[0] && force(m) > 2) m->i[0] = 1;
  if (!m->i[0] && force(m) < -2) m->i[0] = -1;
}
""",
    # A relay without hysteresis, which would have to slide at r[2].
    "relay": """
#define NX 1
#define NZ 1
#define STATES {0}
static void start(M* m) { m->i[0] = 1; }
static void equations(M* m) { m->r[1] = m->i[0] ? 1 : -1; }
static void indicators(M* m, double* z) { z[0] = m->r[0] - m->r[2]; }
static void event(M* m) { m->i[0] = m->r[0] <= m->r[2]; }
""",
    # Passing r[2] shifts the second indicator past zero; the event sees one of them at a time and does not ask again.
    "cascade": """
#define NX 1
#define NZ 2
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = 1; }
static void indicators(M* m, double* z) { z[0] = m->r[0] - m->r[2]; z[1] = m->r[0] + m->i[0] - 1.2; }
static void event(M* m) {
  if (m->i[0] != m->r[0] > m->r[2]) m->i[0] = m->r[0] > m->r[2];
  else m->i[1] = m->r[0] + m->i[0] > 1.2;
}
""",
    # Each event but the first switches it, and its indicator then stands for the other level, on its old side.
    "toggle": """
#define NX 1
#define NZ 1
#define STATES {0}
static void start(M* m) { m->i[0] = 1; }
static void equations(M* m) { m->r[1] = m->i[0] ? 1 : -1; }
static void indicators(M* m, double* z) { z[0] = m->i[0] ? m->r[2] - m->r[0] : m->r[0] - m->r[3]; }
static void event(M* m) { if (m->i[2]) m->i[0] = !m->i[0]; m->i[2] = 1; }
""",
    # Its indicator is zero from r[2] to r[3], and times r[4] elsewhere; r[5] is where the event was that saw it positive.
    "flat": """
#define NX 1
#define NZ 1
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = 1; }
static double zone(M* m) {
  double x = m->r[0];
  return m->r[4] * (x < m->r[2] ? x - m->r[2] : x < m->r[3] ? 0 : x - m->r[3]);
}
static void indicators(M* m, double* z) { z[0] = zone(m); }
static void event(M* m) { if (zone(m) > 0 && !m->i[0]) { m->i[0] = 1; m->r[5] = m->r[0]; } }
""",
    # It announces its next event at r[2] s for ever.
    "past": """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = 1; }
static void indicators(M* m, double* z) {}
static void event(M* m) { m->next = m->r[2]; }
""",
    # Its second indicator is NaN from r[2] s on.
    "undefined": """
#define NX 1
#define NZ 2
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = 1; }
static void indicators(M* m, double* z) { z[0] = m->r[0] + 1; z[1] = sqrt(m->r[2] - m->r[0]); }
static void event(M* m) {}
""",
}
X = [("x", 0, "output", "Real", None)]
RATE = [("der(x)", 1, "local", "Real", None)]
COUNTS = [(f"n{k}", k, "output", "Integer", None) for k in range(4)]


def _parameters(first, **values):
    return [(name, first + k, "parameter", "Real", v) for k, (name, v) in enumerate(values.items())]


VARIABLES = {
    "thermostat": X + RATE + _parameters(2, high=21.0, low=19.0, up=1.0, down=1.0) + COUNTS[:1],
    "levels": X + RATE + _parameters(2, slope=1.0, level=0.5, sign=1.0) + COUNTS,
    "pair": X + RATE + _parameters(2, slope=1.0, a=0.5, b=0.5) + COUNTS[:2],
    "windows": X + RATE + _parameters(2, half=0.01, middle=0.4, later=0.7, level=0.9) + COUNTS[:3],
    "block": X
    + [("v", 1, "output", "Real", None)]
    + [("der(x)", 2, "local", "Real", None), ("der(v)", 3, "local", "Real", None)]
    + _parameters(4, force=3.0, rate=-1.0)
    + COUNTS[:1],
    "relay": X + RATE + _parameters(2, level=0.3) + COUNTS[:1],
    "undefined": X + RATE + _parameters(2, until=0.5),
    "cascade": X + RATE + _parameters(2, level=0.5) + COUNTS[:2],
    "flat": X
    + RATE
    + _parameters(2, low=0.3, high=0.6, scale=1.0)
    + [("at", 5, "output", "Real", None)]
    + COUNTS[:1],
    "toggle": X + RATE + _parameters(2, high=1.0, low=0.5) + COUNTS[:1],
    "past": X + RATE + _parameters(2, next=0.5),
}
SIZES = {"thermostat": (1, 2), "levels": (1, 1), "pair": (1, 2), "block": (2, 3), "relay": (1, 1)}
SIZES["windows"] = (1, 3)
SIZES["undefined"] = (1, 2)
SIZES["cascade"] = (1, 2)
SIZES["flat"] = (1, 1)
SIZES["toggle"] = (1, 1)
SIZES["past"] = (1, 0)
STEP_SIZES = st.sampled_from([0.01, 0.05, 0.1, 0.25, 1.0])
SOME = settings(max_examples=6, deadline=None)
"""Several times as many at night."""


@pytest.fixture(scope="session")
def run_of(tmp_path_factory, needs):
    """Function: table of a run of a model with parameters."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    folder = tmp_path_factory.mktemp("events")

    @cache
    def system_of(name, version):
        key = f"{name}_{version[0]}"
        text = c_fmus.describe(key, version, VARIABLES[name], ("ModelExchange",), *SIZES[name])
        path = c_fmus.build(folder, key, version, SOURCES[name] + UNUSED, text, "ModelExchange")
        return System("one", "one.ssd", {"m": Component("m", read_fmu(path))})

    def run(name, version, stop_time, step_size, **parameters):
        chosen = {f"m.{key}": value for key, value in parameters.items()}
        scenario = Scenario(stop_time=stop_time, step_size=step_size, set=chosen)
        return simulate(system_of(name, version), scenario)

    return run


THERMOSTATS = given(
    width=st.sampled_from([0.5, 1.0, 2.0, 3.3]),
    start=st.sampled_from([0.0, 0.7, 1.0]),
    up=st.sampled_from([0.5, 1.0, 3.0]),
    down=st.sampled_from([0.25, 1.0, 2.0]),
    step_size=STEP_SIZES,
)


@pytest.mark.parametrize("version", VERSIONS)
@SOME
@THERMOSTATS
def test_a_thermostat_stays_between_its_levels(run_of, version, width, start, up, down, step_size):
    # It starts at 0, heats to `high` and then goes to and fro: a triangle of known corners.
    high = start + width
    table = run_of("thermostat", version, 20.0, step_size, high=high, low=start, up=up, down=down)
    t = table["time"].values
    period = width / down + width / up
    since = (t - high / up) % period
    cooling = high - down * since
    heating = start + up * (since - width / down)
    exact = np.where(t < high / up, up * t, np.where(since < width / down, cooling, heating))
    assert np.allclose(table["m.x"], exact, atol=1e-6)


LEVELS = given(
    slope=st.sampled_from([-2.0, -1.0, -0.1, 0.1, 1.0, 3.0]),
    share=st.sampled_from([0.0, 0.1, 0.25, 1 / 3, 0.5, 0.99, 1.0]),
    sign=st.sampled_from([-1.0, 1.0, 1e-6, -1e6]),
    step_size=STEP_SIZES,
)


@pytest.mark.parametrize("version", VERSIONS)
@SOME
@LEVELS
def test_every_comparison_changes_where_the_level_is_passed(
    run_of, version, slope, share, sign, step_size
):
    # At a share of 0 the event is at the start, at 1 at the end, where ">" and "<" have not changed yet.
    level = slope * 2.0 * share
    table = run_of("levels", version, 2.0, step_size, slope=slope, level=level, sign=sign)
    x = slope * table["time"].values
    near = np.abs(x - level) < 1e-9
    for k, holds in enumerate((x > level, x >= level, x < level, x <= level)):
        assert np.array_equal(table[f"m.n{k}"].values[~near], holds[~near].astype(int)), k


PAIRS = given(
    slope=st.sampled_from([-1.0, 0.5, 1.0]),
    a=st.sampled_from([0.25, 0.5, 0.500000001]),
    b=st.sampled_from([0.25, 0.5, 0.75]),
    step_size=STEP_SIZES,
)


@pytest.mark.parametrize("version", VERSIONS)
@SOME
@PAIRS
def test_two_indicators_at_once_are_both_seen(run_of, version, slope, a, b, step_size):
    a, b = np.sign(slope) * a, np.sign(slope) * b
    table = run_of("pair", version, 2.0, step_size, slope=slope, a=a, b=b)
    x = slope * table["time"].values
    for k, level in enumerate((a, b)):
        away = np.abs(x - level) > 1e-8
        assert np.array_equal(table[f"m.n{k}"].values[away], (x > level).astype(int)[away]), k


WINDOWS = given(
    half=st.sampled_from([1e-5, 0.003, 0.01, 0.1]),
    first=st.sampled_from([0.15, 0.401, 0.7, 0.93]),
    second=st.sampled_from([0.4, 0.7, 0.703, 1.6]),
    level=st.sampled_from([0.4, 0.7001, 1.2]),
    step_size=st.sampled_from([0.05, 0.25, 1.0, 2.0]),
)


@pytest.mark.parametrize("version", VERSIONS)
@SOME
@WINDOWS
def test_an_indicator_that_comes_back_within_a_step_is_seen(
    run_of, version, half, first, second, level, step_size
):
    values = {"half": half, "middle": first, "later": second, "level": level}
    table = run_of("windows", version, 2.0, step_size, **values)
    assert [int(table[f"m.n{k}"][-1]) for k in range(3)] == [2, 2, 1]
    assert np.allclose(table["m.x"], table["time"], atol=1e-6)


BLOCKS = given(
    force=st.sampled_from([-3.0, -1.0, 0.0, 2.0, 2.5, 3.0]),
    rate=st.sampled_from([-2.0, -1.0, -0.5, 0.5, 1.0]),
    step_size=STEP_SIZES,
)


@pytest.mark.parametrize("version", VERSIONS)
@SOME
@BLOCKS
def test_a_block_sticks_and_slips_as_its_equations_say(run_of, version, force, rate, step_size):
    table = run_of("block", version, 6.0, step_size, force=force, rate=rate)
    exact = _velocity_of_the_block(force, rate, table["time"].values)
    assert np.allclose(table["m.v"], exact, atol=1e-6)


def _velocity_of_the_block(force, rate, t):
    """Velocity in closed form: parabolas between the times at which it begins and ends to slide."""
    v = np.zeros_like(t)
    now = 0.0
    while now < t[-1]:
        # It sticks until the force is 2 in the way in which the force goes, or slides at once.
        direction = np.sign(rate)
        begins = now
        if abs(force + rate * now) > 2:
            direction = np.sign(force + rate * now)
        else:
            begins = (2 * direction - force) / rate
        # v = (F0 - direction) s + rate s^2 / 2 from there, until it is zero again.
        net = force + rate * begins - direction
        ends = begins - 2 * net / rate if net * rate < 0 else np.inf
        slides = (t >= begins) & (t < ends)
        s = t[slides] - begins
        v[slides] = net * s + rate * s**2 / 2
        now = ends
    return v


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("level", [0.3, 0.5, 1.0])
@pytest.mark.parametrize("step_size", [0.1, 0.25, 2.0])
def test_chattering_ends_the_run_and_says_so(run_of, version, level, step_size):
    with pytest.raises(RunError, match="m: failed in the step .* It chatters at t = ") as caught:
        run_of("relay", version, 4.0, step_size, level=level)
    assert np.all(caught.value.table["m.x"] <= level + 1e-9)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("until", [-1.0, 0.25, 0.5, 0.51, 0.9])
def test_an_indicator_without_a_value_is_named(run_of, version, until):
    with pytest.raises(RunError, match="Its event indicator 2 is no number"):
        run_of("undefined", version, 1.0, 0.1, until=until)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("level", [0.25, 0.5, 0.73])
def test_an_event_that_causes_another_is_followed_by_it(run_of, version, level):
    table = run_of("cascade", version, 1.0, 0.1, level=level)
    passed = table["time"].values > level + 1e-9
    assert np.array_equal(table["m.n0"], passed)
    assert np.array_equal(table["m.n1"], passed)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("low", [0.3, 0.6])
@pytest.mark.parametrize("scale", [1.0, 1e-300, 1e300])
@pytest.mark.parametrize("step_size", [0.1, 1.0])
def test_an_indicator_that_stays_at_zero_or_is_of_any_size_is_located(
    run_of, version, low, scale, step_size
):
    # The solver refuses to go on from such a zero, and does not see a product of tiny values change its sign.
    table = run_of("flat", version, 1.0, step_size, low=low, high=0.6, scale=scale)
    assert float(table["m.at"][-1]) == pytest.approx(0.6, abs=2e-6 * step_size)


@pytest.mark.parametrize("version", ["2.0", "3.0"])  # FMI 1.0 has an event in its initialisation
@pytest.mark.parametrize("step_size", [0.1, 0.25, 5.0])
def test_an_indicator_that_changes_its_meaning_with_the_event_causes_one(
    run_of, version, step_size
):
    table = run_of("toggle", version, 5.0, step_size, high=1.0, low=0.5)
    t = table["time"].values
    # Up to 1, then a triangle between 1 and 0.5 of period 1.
    exact = np.where(t < 1.0, t, 0.5 + np.abs(0.5 - (t - 1.0) % 1.0))
    assert np.allclose(table["m.x"], exact, atol=1e-6)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("next_event", [-1.0, 0.0, 0.25])
def test_an_event_announced_for_the_past_is_refused(run_of, version, next_event):
    with pytest.raises(RunError, match=f"It announces one for t = {next_event:g} s"):
        run_of("past", version, 1.0, 0.1, next=next_event)
