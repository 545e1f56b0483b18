"""Commands on damaged files of a project: scenarios, studies, systems, ships, causes, channel files, tables, results.

`inputs` gives files to the readers; this gives them to the commands, as a user does. An input is the same for the same
number and seed.
"""

import random
import re
import shutil
from pathlib import Path

import numpy as np
from fuzz import damage, damage_xml

STEPS = ["--stop-time", "0.2", "--step-size", "0.1"]
OUT = ["--out", "out"]
NAMES = [
    "a/b",
    "\x1b[31mred",
    "time",
    ".",
    "..",
    "<b>",
    "é😀",
    "a b",
    "x" * 300,
    "%s%n",
    "\u202eabc",
    "a'b\"c",
]
NAMES += [
    "a,b",
    "[m]",
    "a [m]",
    "-x",
    "CON",
    "\\",
    "{}",
    "nan",
    "0",
    "#",
    "&amp;",
    "a=b",
    "*",
    "class",
]
UNITS = [
    "degC/min",
    ".",
    "m**1e9",
    "1/0",
    "furlong",
    "ns",
    "days",
    "%",
    "m/s/s",
    "\x1b[2J",
    "9" * 400,
]
CELLS = [
    "",
    "x",
    "nan",
    "inf",
    "1e308",
    "-1e308",
    "1,5",
    "5e-324",
    "9" * 400,
    "2022-13-45T99:99",
    "time [s]",
]
LONGEST = 200  # characters of a value in a cell


def damaged_text(rng, data):
    """A text with damage, or with words of it exchanged for names that are hard to read."""
    if rng.random() < 0.5:
        return rng.choice(damage.TEXT)(rng, data)
    text = data.decode("utf-8", "replace")
    words = re.findall(r"[\w.]{3,}", text) or ["x"]
    for _ in range(rng.choice((1, 2, 5))):
        new = rng.choice([*NAMES, *damage.VALUES, *words])
        text = text.replace(rng.choice(words), new, rng.choice((1, -1)))
    return text.encode("utf-8", "replace")


def _scenario(rng, folder, project):
    path = _spoilt(rng, sorted(project.glob("scenarios/*.toml")), folder / "own.toml", damaged_text)
    until = ["--until", "0.1", *OUT]
    return [["check", path], ["run", path, *until], ["compare", path, "--stop-time", "0.1"]]


def _study(rng, folder, project):
    for study in project.glob("studies/*.toml"):
        shutil.copy(study, folder)
    path = _spoilt(rng, sorted(project.glob("studies/*.toml")), folder / "own.toml", damaged_text)
    return [["check", path], ["sweep", path, "--runs-at-most", "0", "--workers", "1", *OUT]]


def _system(rng, folder, project):
    own = folder / "own"
    shutil.copytree(
        rng.choice((project / "ssp" / "gunnerus_dp", project / "ssp" / "otter_open")), own
    )
    files = sorted(file for file in own.rglob("*") if file.suffix in (".ssd", ".ssv", ".ssm"))
    victim = rng.choice([*files, own / "SystemStructure.ssd"])
    _spoilt(rng, [victim], victim, rng.choice((damaged_text, *damage_xml.XML)))
    export = ["export", "osp", str(own), "--stop-time", "1", "--step-size", "0.1", *OUT]
    simulate = ["simulate", str(own), *STEPS, *OUT]
    capability = ["capability", str(own), *OUT]
    copy = ["new", "system", "fresh", "--from", str(own)]
    return [["check", str(own)], simulate, ["compare", str(own), *STEPS], export, capability, copy]


def _ship(rng, folder, project):
    own = folder / "ship"
    shutil.copytree(project / "ssp" / "ships" / rng.choice(("otter", "osv", "kvlcc2")), own)
    files = sorted(file for file in own.iterdir() if file.suffix in (".toml", ".csv"))
    victim = rng.choice([*files, own / "ship.toml"])
    _spoilt(rng, [victim], victim, damaged_text)
    ship = str(own / "ship.toml")
    return [
        ["check", ship],
        ["new", "ship", "fresh", "--from", ship, "--yes"],
        ["check", str(victim)],
    ]


def _cause(rng, folder, project):
    causes = sorted(
        (Path(__file__).parents[3] / "src/shipcosim/diagnose/hypotheses/causes").iterdir()
    )
    path = _spoilt(
        rng, [one for one in causes if one.suffix == ".toml"], folder / "own.toml", damaged_text
    )
    return [["check", path]]


def _channels(rng, folder, project):
    write_log(rng, folder / "log.csv", 0)
    names = ("time", "north", "east", "heading", "surge")
    text = "".join(f'{name} = {{ column = "{name}", factor = 1.0 }}\n' for name in names)
    (folder / "sound.toml").write_text(text)
    path = _spoilt(rng, [folder / "sound.toml"], folder / "channels.toml", damaged_text)
    return [[*command, "--channels", path] for command in _on_log(str(folder / "log.csv"))[:5]]


def _table(rng, folder, project):
    path = folder / rng.choice(("log.csv", "log.csv", "log.parquet", "log.xlsx", "log.nc"))
    write_log(rng, path, rng.choice((0, 1, 2, 4)))
    if rng.random() < 0.4:
        path.write_bytes(rng.choice(damage.BYTES)(rng, path.read_bytes()))
    return _on_log(str(path))


def _on_log(log):
    system = ["--system", "otter_open", *OUT]
    commands = [
        ["check", log],
        ["channels", log],
        ["diagnose", log, *system],
        ["replay", log, *system],
    ]
    commands += [
        ["calibrate", log, *system],
        ["diagnose", log, log, *system],
        ["sea-trials", log, *system],
    ]
    return [
        *commands,
        ["report", log, log, *OUT],
        ["simulate", "otter_open", "--inputs", log, *STEPS, *OUT],
    ]


def write_log(rng, path, changes):
    """Write a table of a ship's motion with some columns renamed, in other units, or of other values."""
    from shipcosim.series import make_table
    from shipcosim.series import write_table as write

    n = rng.choice((0, 1, 2, 30, 200))
    units = {
        "time": "s",
        "north": "m",
        "east": "m",
        "heading": "deg",
        "surge": "m/s",
        "wind_speed": "m/s",
    }
    columns = [[name, unit, [str(0.5 * row) for row in range(n)]] for name, unit in units.items()]
    for _ in range(changes):
        column = rng.choice(columns)
        how = rng.randrange(4)
        if how < 2:
            column[how] = rng.choice((NAMES, UNITS)[how])
        else:
            column[2] = (
                [rng.choice(CELLS)] * n if how == 2 else [rng.choice(CELLS) for _ in range(n)]
            )
    headers = [f"{name} [{unit}]" for name, unit, _ in columns]
    if path.suffix == ".nc":
        values = [(name or "x", np.arange(float(n)), unit, "") for name, unit, _ in columns[1:]]
        return write(make_table(np.arange(float(n)), values), path)
    if path.suffix == ".csv":
        rows = zip(*(cells for *_, cells in columns), strict=True)
        text = "\n".join(",".join(row) for row in (headers, *rows))
        return path.write_text(text, encoding="utf-8")
    import pandas

    frame = pandas.DataFrame(
        {header: cells for header, (*_, cells) in zip(headers, columns, strict=True)}
    )
    if path.suffix == ".parquet":
        return frame.to_parquet(path)
    # A workbook holds no control characters.
    return (
        frame.replace(r"[\x00-\x1f]", "", regex=True)
        .rename(columns=repr)
        .to_excel(path, index=False)
    )


def _result(rng, folder, project):
    shutil.copytree(project / "result", folder / "result")
    victim = folder / "result" / rng.choice(("result.nc", "result.csv"))
    _spoilt(rng, [victim], victim, rng.choice(damage.BYTES))
    both = ["report", str(folder / "result"), str(project / "result"), *OUT]
    return [*_on_log(str(victim)), both]


def _spoilt(rng, files, target, spoil):
    target.write_bytes(spoil(rng, rng.choice(files).read_bytes()))
    return str(target)


KINDS = (
    _scenario,
    _study,
    _system,
    _system,
    _ship,
    _ship,
    _cause,
    _channels,
    _table,
    _table,
    _result,
)


def write_command(seed, number, folder, project):
    """Write a damaged file into an empty folder.

    Parameters
    ----------
    seed, number : str, int
        Which.
    folder, project : Path
        Where to; a project with its FMUs and, in `result`, the results of a run.

    Returns
    -------
    list of str
        A command on the file.
    """
    rng = random.Random(f"{seed} {number}")
    return rng.choice(rng.choice(KINDS)(rng, folder, project))
