"""At night: the command `diagnose` on logs of the independent truth: verdict, exit code, files, and what it refuses."""

import json

from typer.testing import CliRunner

from shipcosim.cli import app


def rounded_like(shown, found):
    """Numbers of an answer with as many digits as a page shows of them."""
    if isinstance(shown, dict):
        return {key: rounded_like(shown.get(key), value) for key, value in found.items()}
    if isinstance(shown, list) and len(shown) == len(found):
        return [rounded_like(*pair) for pair in zip(shown, found, strict=True)]
    return (
        float(f"{found:.{len(f'{shown:g}'.replace('.', '').lstrip('0'))}g}")
        if isinstance(shown, float)
        else found
    )


def test_the_page_of_the_docs_shows_the_answer_to_its_example(root, tmp_path, monkeypatch):
    monkeypatch.chdir(root)
    log, out = "docs/examples/gunnerus_log.csv.gz", tmp_path / "found"
    assert CliRunner().invoke(app, ["diagnose", log, "--out", str(out)]).exit_code == 1
    found = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    page = (root / "docs" / "diagnosis-json.md").read_text(encoding="utf-8")
    shown = json.loads(page.split("```json")[1].split("```")[0])
    assert f"the first of {len(found['smallest_visible'])} entries" in page
    found["smallest_visible"] = found["smallest_visible"][:1]
    assert rounded_like(shown, found) == shown
