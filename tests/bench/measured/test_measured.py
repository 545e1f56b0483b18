"""At night: logs of real craft through the whole diagnosis: no crash, figures of the error, time and memory."""

import pytest
from measured.logs import FOLDERS, files
from measured.test_measured import MEASURED, diagnosed, fmus, has_figures, log

HERE = [craft for craft in FOLDERS if (MEASURED / FOLDERS[craft]).is_dir()]


LOGS = [(craft, path.name) for craft in HERE for path in files(MEASURED.parent, craft)]


@pytest.mark.parametrize(("craft", "name"), LOGS)
def test_every_log_goes_through_the_whole_diagnosis(craft, name, log, fmus):
    found = diagnosed(*log(craft, name), fmus)
    assert has_figures(found)
    if craft == "kvlcc2":
        has_velocities_of_the_earth(found)


def has_velocities_of_the_earth(found):
    """HSVA's columns u and v are the rates of x and y to 1 mm/s; as those of the body they are off by 5 cm/s."""
    frames = [finding for finding in found.findings if finding.cause == "frame"]
    assert [set(finding.channels) for finding in frames] == [{"surge", "sway"}]
    assert "north and east" in frames[0].note
