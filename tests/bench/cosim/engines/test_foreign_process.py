"""At night: systems that CI leaves out, run here as a tool takes them, have the tool's values."""

import pytest
from cosim.engines.test_foreign_process import SILENT, check_as_read, host


@pytest.mark.parametrize("name", [name for name in SILENT if name not in SILENT[::3]])
def test_run_here_as_a_tool_takes_it_a_system_has_the_tools_values(name, host, tmp_path):
    check_as_read(name, host, tmp_path)
