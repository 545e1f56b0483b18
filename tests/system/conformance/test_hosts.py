"""`check --for` a tool says something of a system exactly where that tool was found not to do it right."""

import pytest
from conformance.cases import cases, write
from conformance.recording import FORMED, RIGHT, rows

from shipcosim.checks import check_any

TOLD = "has to be told it in the call"
"""What the recording does tell it, unless this is what the file is to say."""


@pytest.mark.parametrize(
    "row", [name for name in rows() if name in FORMED or not cases()[name].gap]
)
@pytest.mark.parametrize("host", ["libcosim", "ecos"])
def test_check_for_a_tool_says_something_where_the_tool_is_not_right_and_nowhere_else(
    host, row, stated, tmp_path
):
    case = cases()["connection" if row in FORMED else row]
    form = FORMED[row][2] if row in FORMED else "ssp, 1.0" if "1.0" in case.versions else "ssp, 2.0"
    path = str(write(case, tmp_path, form))
    plain = set(check_any(path))
    said = [problem for problem in check_any(path, None, (host,)) if problem not in plain]
    if "step_size" not in case.run:
        said = [problem for problem in said if TOLD not in problem.found]
    assert (stated[host][rows()[row][1]] == RIGHT) == (said == []), "\n".join(map(str, said))
