import ast
import textwrap

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.fmi.export.bundle import bundle


@pytest.fixture
def folder(tmp_path):
    def write(**modules):
        for name, text in modules.items():
            (tmp_path / f"{name}.py").write_text(textwrap.dedent(text))
        return tmp_path / "main.py"

    return write


def code(bundled, name="main"):
    return bundled.files[f"{bundled.package}/{name}.py"].decode()


def test_only_what_is_reached_by_imports_comes_along(folder):
    script = folder(
        main="from helper import a\nimport math\n",
        helper="def f():\n    from shipcosim.models.core.maths import sin\n    import late\na = 1\n",
        late="",
        never="",
    )
    bundled = bundle(script)
    names = {path.removeprefix(f"{bundled.package}/") for path in bundled.files}
    assert names == {
        "__init__.py",
        "main.py",
        "helper.py",
        "late.py",
        "shipcosim/__init__.py",
        "shipcosim/models/__init__.py",
        "shipcosim/models/core/__init__.py",
        "shipcosim/models/core/maths.py",
    }


@pytest.mark.parametrize(
    "statement, expected",
    [
        ("import helper", "import P.helper as helper"),
        ("import helper as h, math", "import P.helper as h, math"),
        (
            "import shipcosim.models.core.maths",
            "import P.shipcosim.models.core.maths, P.shipcosim as shipcosim",
        ),
        ("import shipcosim.models.core.maths as m", "import P.shipcosim.models.core.maths as m"),
        ("from shipcosim.models.core import maths", "from P.shipcosim.models.core import maths"),
        ("from  helper  import (\n    a,\n    b\n)", "from  P.helper  import (\n    a,\n    b\n)"),
        ("é = 'é'; import helper; x = 1", "é = 'é'; import P.helper as helper; x = 1"),
        ("import math, \\\n    helper  # why", "import math, P.helper as helper \\\n  # why"),
        ("from os import path", "from os import path"),
    ],
)
def test_imports_lead_into_the_package_and_lines_stay(folder, statement, expected):
    bundled = bundle(folder(main=f"{statement}\nlast = 1\n", helper="a = b = 1\n"))
    text = code(bundled)
    assert text == f"{expected}\nlast = 1\n".replace("P", bundled.package)
    assert ast.parse(text).body[-1].lineno == statement.count("\n") + 2


def test_relative_imports_of_a_package_beside_the_script_are_followed(folder, tmp_path):
    (tmp_path / "pack").mkdir()
    modules = {
        "pack/__init__": "",
        "pack/one": "from . import two\nfrom .two import x\n",
        "pack/two": "x = 1\n",
    }
    script = folder(main="from pack.one import x\n", **modules)
    bundled = bundle(script)
    assert f"{bundled.package}/pack/two.py" in bundled.files
    assert code(bundled, "pack/one") == "from . import two\nfrom .two import x\n"


def test_names_change_with_the_content_of_every_module(folder):
    first = bundle(folder(main="import helper\n", helper="a = 1\n"))
    again = bundle(folder(main="import helper\n", helper="a = 1\n"))
    other = bundle(folder(main="import helper\n", helper="a = 2\n"))
    assert first == again
    assert first.package != other.package and first.entry != other.entry


def test_trained_weights_come_along_and_count_as_content(folder, tmp_path):
    script = folder(main="a = 1\n")
    without = bundle(script)
    (tmp_path / "weights").mkdir()
    (tmp_path / "weights" / "report.md").write_text("how they were trained")
    assert bundle(script) == without
    found = []
    for content in (b"one", b"two"):
        (tmp_path / "weights" / "net.npz").write_bytes(content)
        found.append(bundle(script))
        assert found[-1].files[f"{found[-1].package}/weights/net.npz"] == content
    assert len({without.entry, *(one.entry for one in found)}) == 3


def test_line_ends_of_another_system_change_nothing(folder):
    script = folder(main="a = 1\nb = 2\n")
    first = bundle(script)
    script.write_bytes(b"a = 1\r\nb = 2\r\n")
    assert bundle(script) == first


def test_all_that_an_fmu_cannot_carry_is_reported_at_once(folder):
    script = folder(
        main="import pandas\nimport helper\n",
        helper="import numpy, json\nfrom scipy.linalg import inv\n",
    )
    with pytest.raises(ShipcosimError) as caught:
        bundle(script)
    text = str(caught.value)
    assert (
        "main.py, line 1: imports pandas" in text
        and "helper.py, line 2: imports scipy.linalg" in text
    )


def test_imports_that_do_not_run_in_an_fmu_are_no_problem(folder):
    bundle(
        folder(
            main="""
            from typing import TYPE_CHECKING
            try:
                import torch
            except ImportError:
                torch = None
            if TYPE_CHECKING:
                import pandas
            def plot():
                import matplotlib
            if __name__ == "__main__":
                import plotly
            """
        )
    )


def test_a_syntax_error_is_reported_with_file_and_line(folder):
    with pytest.raises(ShipcosimError, match=r"helper\.py, line 2"):
        bundle(folder(main="import helper\n", helper="a = 1\nb = = 2\n"))
