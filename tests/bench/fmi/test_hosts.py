"""At night: built FMUs in their hosts: FMPy, a process without this package, libcosim, ecos."""

import json
import subprocess
import textwrap
import venv

import pytest
from fmi.test_hosts import given_to

from shipcosim.library import build_stale


def test_all_fmus_of_the_project_run_in_an_environment_with_only_fmpy_installed(root, tmp_path):
    """A fresh virtual environment, NumPy comes with FMPy; skips where no package index can be reached."""
    fmus = build_stale(root)
    venv.create(tmp_path / "venv", with_pip=True)
    python = next(path for path in (tmp_path / "venv").glob("*/python*") if path.is_file())
    installed = subprocess.run(
        [python, "-m", "pip", "install", "-q", "fmpy"], capture_output=True, text=True
    )
    if installed.returncode:
        pytest.skip(f"needs a package index: {installed.stderr[-200:]}")
    code = """
    import json, sys
    from fmpy import simulate_fmu
    for fmu, given in json.loads(sys.argv[1]).items():
        print(len(simulate_fmu(fmu, stop_time=5.0, step_size=0.05, output_interval=0.05, start_values=given)))
    """
    given = given_to([fmu.stem for fmu in sorted(fmus.glob("*.fmu"))], root)
    given = {str(fmus / f"{name}.fmu"): values for name, values in given.items()}
    command = [python, "-I", "-c", textwrap.dedent(code), json.dumps(given)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["101"] * len(given)
