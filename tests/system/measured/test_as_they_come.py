"""Published logs as they come, with the channel file that is proposed: the same as by the ones written by hand."""

from pathlib import Path

import numpy as np
import pytest
from measured.logs import CHANNELS, FOLDERS, as_table, files

from shipcosim.diagnose.log.channels import ChannelFile
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of, read_log

SHARED = Path(__file__).resolve().parents[3].parent / "shared"
THRUSTERS = {
    "blueboat": {"left": ("thrust",), "right": ("thrust",)},
    "otter": {"left": ("rpm",), "right": ("rpm",)},
    "kvlcc2": {"propeller": ("rpm", "azimuth")},
}
NAMES = {"kvlcc2": tuple("t x y psi u v r roll rudder n thrust torque".split())}
BY_HAND = {"kvlcc2": {"propeller_rpm"}}
"""Roles whose unit only its authors say: turns a second."""


@pytest.mark.skipif(
    not (SHARED / "measured").is_dir(), reason="needs the logs in ../shared/measured, not here"
)
@pytest.mark.parametrize("craft", THRUSTERS)
def test_the_proposed_channel_file_reads_what_the_one_by_hand_does(craft, tmp_path):
    for path in files(SHARED, craft)[-2:]:
        assert FOLDERS[craft] in str(path)
        by_hand = read_log(as_table(path, tmp_path), CHANNELS / f"{craft}.toml")
        form = FileLayout(names=NAMES.get(craft))
        proposal = propose(columns_of(path, form), THRUSTERS[craft], form)
        log = read_log(path, ChannelFile(proposal.channels(guessed=True), form), THRUSTERS[craft])
        begun = [table["time"].values - table["time"].values[0] for table in (log, by_hand)]
        assert begun[0] == pytest.approx(
            begun[1], abs=0.2 if craft == "otter" else 1e-5
        )  # she has two clocks
        for role in set(by_hand.data_vars) - BY_HAND.get(craft, set()):
            # A velocity that was turned by a heading of 0 before there is one is none.
            right = np.where(
                np.isnan(log["heading"].values), log[role].values, by_hand[role].values
            )
            assert np.allclose(log[role].values, right, equal_nan=True, atol=1e-9), (
                path.name,
                role,
            )
