"""What predictors learn as a force, shown to the diagnosis: `python tests/bench/prediction/learned.py`.

A DP ship has one effect hidden in her, and is brought from place to place for forty minutes. Two predictors learn from
what she knows of herself; then her model, with the learned force and without the effect, sails the same plan.
"""

import argparse
import shutil
import sys
from dataclasses import fields
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
if __name__ == "__main__":  # as a test its folders are on the path already
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # prediction; ships

import shipcosim  # noqa: E402
from prediction import measuring  # noqa: E402
from prediction.rivals import ROOT  # noqa: E402
from shipcosim.fmi.export.builder import build_fmu  # noqa: E402
from shipcosim.learn.prediction import paper_iv, rollouts, training  # noqa: E402
from shipcosim.learn.prediction.worlds import KNOWN, World, draw, scenario  # noqa: E402
from shipcosim.models.core.networks import read_arrays  # noqa: E402
from shipcosim.models.prediction import drift_off, own_model, own_record  # noqa: E402
from shipcosim.models.ship.hull import HullParameters  # noqa: E402
from shipcosim.scenario import Event  # noqa: E402

FOLDER = ROOT / "results" / "learned"
END = 2400.0
HIDDEN = {
    "nothing": {},
    "drag": {"vessel.drag_scale": 1.6},
    "crossflow": {"vessel.cross_flow_scale": 1.4},
    "wind_scale": {"vessel.wind_load_scale": 1.4},
    "tunnel thrust_loss": {"tunnel.thrust_loss": 0.3},
    "azimuth thrust_loss": {"port.thrust_loss": 0.3},
}
CALM = {
    "environment.current_speed": 0.0,
    "environment.significant_wave_height": 0.02,
    "environment.wind_speed": 6.0,
}
"""Nothing but the ship is wrong: no current, hardly a wave. [m/s, m, m/s]"""
RIGHT = {
    "wind_scale": {"wind_X": 0.4, "wind_Y": 0.4, "wind_N": 0.4},
    "tunnel thrust_loss": {"thrust_bow": -0.3},
}
"""Coefficients that a predictor without errors would find: with these the force must get its name."""
FORCE = {
    **{f"vessel.{name}": f"learned.{name}" for name in ("u", "v", "r", "u_r", "v_r")},
    **{f"vessel.tau_wind_{axis}": f"learned.wind_{axis}" for axis in "XYN"},
    **{
        f"{unit}.tau_{axis}": f"learned.{unit}_{axis}"
        for unit in ("port", "starboard")
        for axis in "XYN"
    },
    **{f"tunnel.tau_{axis}": f"learned.tunnel_{axis}" for axis in "YN"},
    **{f"learned.tau_{axis}": f"vessel.tau_{axis}_6" for axis in "XYN"},
}


def plan(seed: int, effect: dict[str, float], distance: float = 0.0) -> World:
    """Forty minutes: a new place every 120 s, by the seed; weather and ship as worlds have them."""
    drawn, rng = draw(seed, distance), np.random.default_rng([27, seed])
    events = [
        Event(
            time=float(time),
            override={
                "reference.x_set": rng.uniform(-20.0, 20.0),
                "reference.y_set": rng.uniform(-20.0, 20.0),
                "reference.psi_set": rng.uniform(-np.pi / 2.0, np.pi / 2.0),
            },
        )
        for time in np.arange(60.0, END - 60.0, 120.0)
    ]
    return World(seed, distance, END, drawn.set | CALM | effect, tuple(events))


def sailed(world: World, force: Path | None = None, until: float = END) -> "shipcosim.Run":
    """The run of a plan; with a force, the FMU that gives it."""
    what = scenario(world, drift=0.0)
    system = shipcosim.read("ssp/gunnerus_dp").copy()
    if force is not None:
        system.add_component("learned", force)
        for source, target in FORCE.items():
            system.connect(source, target)
        for name in HULL:
            system.set(f"learned.{name}", system.parameters[f"vessel.{name}"])
    return shipcosim.simulate(system, what, until=until)


def source(name: str) -> str:
    """Signal that feeds an input of the predictor."""
    if name.endswith("_allocated"):
        return f"allocator.{name.removesuffix('_allocated')}"
    return f"{'sensors' if name.endswith('_meas') else 'controller'}.{name}"


def known(run) -> np.ndarray:
    """Inputs of a predictor, a row a second; columns `KNOWN`."""
    return np.column_stack([np.asarray(run.table[source(name)], float) for name in KNOWN])


HULL = tuple(field.name for field in fields(HullParameters))


def own_coefficients(rows: np.ndarray, ship) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of the residual load at the end of a record and their standard deviations, means over filters."""
    arrays = read_arrays(ROOT / "fmus" / "drift_predictor" / "weights" / "ours.npz")
    learned = drift_off.trained_of(arrays).learned
    everything = [rollouts.known_of(row[None], ship) for row in rows]
    record = own_record.begin(everything[0], learned=learned, hull=ship.hull)
    for now in everything[1:]:
        record = own_record.step(record, now, 1.0, learned=learned, hull=ship.hull, wind=ship.wind)
    spread = np.sqrt(np.diagonal(record.covariance, axis1=-2, axis2=-1))
    mean, std = np.tensordot(
        own_record.weights(record)[:, 0], np.stack([record.mean[:, 0], spread[:, 0]], axis=1), 1
    )
    return mean[own_model.COEFFICIENT], std[own_model.COEFFICIENT]


def networks(rows: np.ndarray, ship) -> dict[str, np.ndarray]:
    """Networks of paper IV, trained on this record alone."""
    inputs, targets = paper_iv.samples(rollouts.Sailed(rows[:, None, :], len(rows)), ship)
    return paper_iv.fit(inputs, targets, training.PAPER_IV, lambda done, total: None)[0]


def force_of(arrays: dict[str, np.ndarray], folder: Path) -> Path:
    """The FMU of a learned force."""
    source = folder / "learned_force"
    shutil.copytree(HERE.parent / "learned_force", source, dirs_exist_ok=True)
    measuring.save(source / "weights" / "learned.npz", **arrays)
    return build_fmu(source, folder)


def said(run: "shipcosim.Run") -> str:
    """What the diagnosis says of a run."""
    found = shipcosim.diagnose(run, "gunnerus_open").as_json()
    causes = [
        "/".join([one["cause"], *([one["component"]] if one["component"] else []), *sizes(one)])
        for one in found["findings"]
    ]
    return f"{found['verdict']}: {', '.join(causes)}; {'; '.join(one['what'] for one in found['discrepancies'])}"


def sizes(finding: dict) -> list[str]:
    """Estimates of a finding, in words."""
    return [
        f"{name} {one['estimate']:.3g} {one['unit']}" for name, one in finding["parameters"].items()
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=301)
    parser.add_argument("--distance", type=float, default=0.0)
    args = parser.parse_args()
    ship, model = training.ship(), plan(args.seed, {})
    for name, right in RIGHT.items():
        force = {"coefficients": np.array([right.get(one, 0.0) for one in own_model.COEFFICIENTS])}
        print(
            name,
            "| the right force |",
            said(sailed(model, force_of(force, FOLDER / "right"))),
            flush=True,
        )
    for name, effect in HIDDEN.items():
        place = FOLDER / name.replace(" ", "-")
        truth = sailed(plan(args.seed, effect, args.distance))
        print(name, "| truth |", said(truth), flush=True)
        rows = known(truth)
        mean, std = own_coefficients(rows, ship)
        print(name, "| ours: coefficients |", shown(mean, std), flush=True)
        with_ours = sailed(model, force_of({"coefficients": mean}, place / "ours"))
        print(name, "| ours |", said(with_ours), flush=True)
        with_networks = sailed(model, force_of(networks(rows, ship), place / "paper-iv"))
        print(name, "| paper IV |", said(with_networks), flush=True)


def shown(mean: np.ndarray, std: np.ndarray) -> str:
    """Coefficients that are off nought by more than two standard deviations."""
    sure = [
        (name, m, s)
        for name, m, s in zip(own_model.COEFFICIENTS, mean, std, strict=True)
        if abs(m) > 2.0 * s
    ]
    return ", ".join(f"{name} {m:.2f} +- {s:.2f}" for name, m, s in sure) or "none is sure"


if __name__ == "__main__":
    main()
