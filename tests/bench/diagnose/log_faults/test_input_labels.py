"""At night: what a log is said to be in which a channel of thrusters or wind is wrong, in half of it or throughout.

`pytest tests/bench/diagnose/log_faults/test_input_labels.py -s` prints the answers.
"""

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.pipeline import find_causes
from truth import draw

PORT = ("port_rpm", "port_azimuth", "starboard_rpm", "starboard_azimuth")
WRONG = {
    "wind at 0": ("wind_speed", lambda values: 0.0 * values, True),
    "wind turned round": ("wind_from", lambda values: np.mod(values + 180.0, 360.0), False),
    "azimuth late": ("port_azimuth", lambda values: np.r_[values[:6], values[:-6]], False),
    "speed late": ("port_rpm", lambda values: np.r_[values[:5], values[:-5]], False),
    "units exchanged": (PORT, None, False),
}
"""Role, what is logged, and whether that is so throughout or in the second half of a log only."""


def wrong(log, name):
    """A log of the truth with a channel wrong, and the roles that are."""
    roles, changed_to, is_throughout = WRONG[name]
    columns = {column.split(" [")[0]: column for column in log.columns}
    here = np.arange(len(log)) >= (0 if is_throughout else len(log) // 2)
    log = log.copy()
    if changed_to is not None:
        values = log[columns[roles]].to_numpy()
        log[columns[roles]] = np.where(here, changed_to(values), values)
        return log, (roles,)
    both = [columns[role] for role in roles]
    log.loc[here, both] = log.loc[here, both[2:] + both[:2]].to_numpy()
    return log, roles


@pytest.mark.parametrize("name", WRONG)
def test_hardly_a_cause_of_the_ship_is_named_for_a_wrong_channel(name, tmp_path):
    right = 0
    of_ship = 0
    for seed, kind in enumerate(("trial", "work", "hold", "trial"), 9200):
        log, roles = wrong(draw(kind, seed, causes=0, minutes=20, form=seed % 2).log, name)
        log.to_csv(tmp_path / "log.csv", index=False)
        found = find_causes(tmp_path / "log.csv", twin.system())
        print(f"\n{name}, {kind}, seed {seed}: {found.verdict}", end="")
        print("".join(f"; {one.label} {one.channels} {one.segments}" for one in found.findings))
        of_ship += any(one.kind == "physics" for one in found.findings)
        right += any(set(one.channels) & set(roles) for one in found.findings)
    assert of_ship <= 1 and right >= 1


def test_a_wind_in_knots_in_the_second_half_is_no_larger_wind_load(tmp_path):
    """The rough segment of the label, the whole log, explains less than no label; the settled one gains 304 nats."""
    log = draw("work", 92006, causes=0, minutes=30).log
    (speed,) = (column for column in log.columns if column.startswith("wind_speed"))
    log.loc[len(log) // 2 :, speed] *= 1.9438
    log.to_csv(tmp_path / "log.csv", index=False)
    (finding,) = find_causes(tmp_path / "log.csv", twin.system()).findings
    assert finding.note == "wind_speed is in kn, not m/s"
    assert finding.segments[0][0] == pytest.approx(900.0, abs=30.0)
