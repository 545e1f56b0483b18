"""The project's diagnosis beside its rivals, on the same logs."""

from trial.runs import KINDS, key
from trial.tables import ROWS, content

LABELS = {
    "trial.tools:ours": "shipcosim",
    "rivals.regressions:inverse_dynamics": "inverse dynamics, BIC",
    "rivals.regressions:sparse_regression": "PySINDy on the residual",
}
NAMES = ("one", "healthy", "unknown", "two", "data")


def comparison(results):
    """Rates of every tool on the logs that all tools have diagnosed, as Markdown.

    Parameters
    ----------
    results : list of dict
        As `runs.run` gives them, of several tools.

    Returns
    -------
    str
    """
    by_tool = {tool: [r for r in results if r["tool"] == tool] for tool in LABELS}
    by_tool = {tool: found for tool, found in by_tool.items() if found}
    common = set.intersection(*({key(r) for r in found} for found in by_tool.values()))
    lines = [
        "| | " + " | ".join(LABELS[tool] for tool in by_tool) + " |",
        "|---|" + "---|" * len(by_tool),
    ]
    for row in ROWS:
        for kind in KINDS if row.name in NAMES else ():
            mine = [[r for r in found if key(r) in common] for found in by_tool.values()]
            cells = [content(row, found, kind) for found in mine]
            if any(cells):
                lines.append(f"| {kind}, {row.label} | " + " | ".join(cells) + " |")
    return f"{len(common)} logs.\n\n" + "\n".join(lines)
