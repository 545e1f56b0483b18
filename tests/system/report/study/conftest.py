"""Made-up studies of the form that `shipcosim sweep` leaves: the page's tests need no run."""

import numpy as np
import pandas as pd
import pytest

from shipcosim.report.study import StudyTables
from shipcosim.sweep.summary import wilson

LOST = ["intact", "bow lost", "port lost"]
COLUMNS = [
    {
        "name": "direction",
        "role": "factor",
        "unit": "rad",
        "description": "direction of wind, waves and current",
    },
    {"name": "wind", "role": "factor", "unit": "m/s", "description": "mean wind speed"},
    {"name": "lost", "role": "factor", "unit": None, "description": "what is lost", "labels": LOST},
    {"name": "seed", "role": "factor", "unit": "1", "description": "seed of wind and waves"},
    {"name": "current", "role": "sample", "unit": "m/s", "description": "speed of the current"},
    {
        "name": "excursion",
        "role": "quantity",
        "unit": "m",
        "description": "largest distance off the set point",
    },
    {
        "name": "power",
        "role": "quantity",
        "unit": "W",
        "description": "mean power of the thrusters",
    },
    {
        "name": "time_to_3_m",
        "role": "quantity",
        "unit": "s",
        "description": "time until she is 3 m off",
    },
    {"name": "held", "role": "quantity", "unit": "1", "description": "she stayed within 3 m"},
    {
        "name": "excursion_90",
        "role": "summary",
        "unit": "m",
        "description": "excursion that one seed in ten exceeds",
    },
    {
        "name": "held_share",
        "role": "summary",
        "unit": "1",
        "description": "share of seeds that held",
    },
]
STUDY = {
    "description": "Which weather she holds, with what is lost",
    "scenario": "stationkeeping",
    "seed": 1,
    "stop_time": "15 min",
    "set": {"environment.current_from": "180 deg"},
    "factor": [
        {
            "name": "direction",
            "signal": "environment.wind_from",
            "from": "0 deg",
            "to": "330 deg",
            "step": "30 deg",
        },
        {
            "name": "wind",
            "signal": "environment.wind_speed",
            "values": ["6 m/s", "9 m/s", "12 m/s"],
        },
        {"name": "lost", "case": [{"label": label, "set": {}, "events": []} for label in LOST]},
        {"name": "seed", "seeds": 6},
    ],
    "sample": {
        "method": "sobol",
        "runs": 8,
        "of": {
            "environment.current_speed": {
                "distribution": "norm",
                "loc": 0.3,
                "scale": 0.1,
                "unit": "m/s",
            }
        },
    },
    "quantity": [
        {
            "name": "excursion",
            "signal": ["vessel.x", "vessel.y"],
            "near": [0.0, 0.0],
            "reduce": "maximum",
        },
        {"name": "power", "signal": "switchboard.power", "reduce": "mean"},
        {
            "name": "held",
            "expect": [{"signal": ["vessel.x", "vessel.y"], "near": [0.0, 0.0], "within": "3 m"}],
        },
    ],
    "summary": [
        {
            "name": "excursion_90",
            "quantity": "excursion",
            "over": "seed",
            "statistic": "percentile",
            "percentile": 90,
        }
    ],
    "tracks": {"signals": ["vessel.x", "vessel.y", "vessel.psi"], "interval": "5 s"},
    "view": [
        {
            "kind": "polar",
            "angle": "direction",
            "radius": "excursion_90",
            "title": "Excursion, wind 12 m/s",
            "table": "worst",
        },
        {"kind": "curves", "quantity": "time_to_3_m", "series": "lost"},
        {
            "kind": "bars",
            "category": "parameter",
            "value": ["first_order", "total"],
            "table": "indices",
        },
        {"kind": "pareto", "quantities": ["excursion", "power", "current"]},
        {"kind": "scatter", "x": "current", "y": "excursion", "series": "lost"},
        {"kind": "tracks", "series": "lost", "circles": [5.0, 10.0, 25.0]},
    ],
}
PROBLEM = "vessel: step to 312.4 s failed: FloatingPointError: the roll angle is not finite"


def made_up_runs(seeds, generator):
    """Runs over direction, wind, what is lost and seeds; one in a hundred failed."""
    grid = np.meshgrid(
        np.radians(np.arange(0, 360, 30)),
        [6.0, 9.0, 12.0],
        np.arange(3),
        np.arange(seeds),
        indexing="ij",
    )
    direction, wind, lost, seed = (part.ravel() for part in grid)
    count = len(direction)
    current = generator.normal(0.3, 0.1, count)
    load = wind**2 * (0.3 + 0.7 * np.sin(direction) ** 2) + 200 * current**2
    excursion = (
        0.004 * load * (1 + 1.2 * lost) * np.exp(0.3 * generator.standard_normal(count)) + 0.4
    )
    failed = generator.uniform(size=count) < 0.01
    late = np.where(
        excursion > 3.0,
        900.0 / excursion**0.8 * np.exp(0.2 * generator.standard_normal(count)),
        np.nan,
    )
    runs = {
        **{"run": np.arange(1, count + 1), "direction": direction, "wind": wind},
        **{
            "lost": np.array(LOST)[lost.astype(int)],
            "seed": (1000 * seed + 17).astype(int),
            "current": current,
        },
        **{
            "excursion": np.where(failed, np.nan, excursion),
            "power": np.where(failed, np.nan, 900 * load + 4e4),
        },
        "time_to_3_m": np.where(failed, np.nan, late),
        "held": [
            None if bad else bool(size <= 3.0) for bad, size in zip(failed, excursion, strict=True)
        ],
        "error": [PROBLEM if bad else "" for bad in failed],
    }
    return pd.DataFrame(runs)


def made_up_summary(runs):
    """A row for each direction, wind and loss, with Wilson's interval of the share that held."""
    rows = []
    for (direction, wind, lost), some in runs.groupby(["direction", "wind", "lost"], sort=False):
        known = some["held"].dropna().astype(bool)
        _, low, high = wilson(int(known.sum()), len(known))
        row = {
            "direction": direction,
            "wind": wind,
            "lost": lost,
            "excursion_90": some["excursion"].quantile(0.9),
        }
        rows.append(
            row | {"held_share": known.mean(), "held_share_low": low, "held_share_high": high}
        )
    return pd.DataFrame(rows)


def made_up_tracks(runs, generator):
    """She drifts with the current and turns across the wind, half a minute of rows every 10 s."""
    time, parts = np.arange(0, 301, 10.0), []
    for run in runs.itertuples():
        psi = 0.3 * np.sin(time / 80 + generator.uniform(0, 6)) + 0.002 * time
        speed = 0.12 * run.current * (1 + LOST.index(run.lost))
        away = run.direction + np.pi + 0.2 * generator.standard_normal()
        walk = np.cumsum(generator.normal(0, 0.08, (2, len(time))), axis=1)
        north, east = speed * time * np.cos(away) + walk[0], speed * time * np.sin(away) + walk[1]
        parts.append(
            pd.DataFrame(
                {
                    "run": run.run,
                    "time": time,
                    "vessel.x": north,
                    "vessel.y": east,
                    "vessel.psi": psi,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def made_up_indices():
    """Sobol indices with their intervals."""
    first, total = np.array([0.42, 0.2, 0.11, 0.02]), np.array([0.55, 0.3, 0.12, 0.03])
    table = {"parameter": ["vessel.mass", "vessel.X_u", "environment.current_speed", "vessel.Y_v"]}
    for name, values in (("first_order", first), ("total", total)):
        table |= {name: values, f"{name}_low": values - 0.05, f"{name}_high": values + 0.05}
    return pd.DataFrame(table)


def made_up_study(seeds=6, study=STUDY, with_tracks=True, **about):
    """A study as the page takes it; `seeds` for each of 108 combinations."""
    generator = np.random.default_rng(5)
    runs = made_up_runs(seeds, generator)
    summary = made_up_summary(runs)
    worst = summary[summary["wind"] == 12.0].drop(columns="wind")
    known = {
        **{
            "name": "dp_weather",
            "study": study,
            "columns": COLUMNS,
            "engine": "native",
            "plan": "3f1c0a9e",
        },
        "runs": {
            "planned": len(runs),
            "done": len(runs),
            "failed": int((runs["error"] != "").sum()),
        },
        "versions": {"shipcosim": "0.1", "numpy": "2.3"},
        "ship": {"length": 33.9, "breadth": 9.6},
        "beside": [
            {
                **{"radius": "excursion_90", "name": "static", "series": "intact"},
                "angle": np.radians(np.arange(0, 360, 10)).tolist(),
                "radius_values": (1.5 + np.sin(np.radians(np.arange(0, 360, 10))) ** 2).tolist(),
            }
        ],
    }
    return StudyTables(
        about=known | about,
        runs=runs,
        summary=summary,
        tracks=made_up_tracks(runs[::4], generator) if with_tracks else None,
        tables={"indices": made_up_indices(), "worst": worst},
        pages=(4,),
        command="shipcosim sweep dp_weather",
    )


@pytest.fixture(scope="session")
def study_of():
    """Function from a number of seeds to a made-up study."""
    return made_up_study
