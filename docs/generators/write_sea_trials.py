"""Writes docs/generated/sea-trials-2022.md and its picture: R/V Gunnerus' trials of 2022 by `shipcosim sea-trials`.

Run `python docs/generators/write_sea_trials.py` after the sea trials' part of the diagnosis, its causes or the ship has
changed. It needs the measured log in ../shared and matplotlib; a minute on one core.
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from shipcosim.diagnose.sea_trials.evidence import changes_of
from shipcosim.diagnose.sea_trials.sailing import sailed
from shipcosim.diagnose.sea_trials.study import errors, estimates, study
from shipcosim.library import build_stale
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[2]
LOG = ROOT.parent / "shared" / "measured" / "gunnerus_trials_2022" / "trials.csv"
CHANNELS = ROOT / "tests" / "system" / "measured" / "channels" / "gunnerus.toml"
PAGE = ROOT / "docs" / "generated" / "sea-trials-2022.md"
PICTURE = ROOT / "docs" / "generated" / "pictures" / "sea_trials_2022.png"
SHOWN = (
    "speed",
    "rate",
    "t90",
    "t180",
    "t20",
    "speed at 90",
    "advance",
    "transfer",
    "tactical diameter",
    "drift",
)
MEASURED, BEFORE, AFTER = "#c8501e", "#8a8a8a", "#1f5fa8"
OTHER = {"port": "starboard", "starboard": "port"}


def sets_table(ranking, most=8):
    """The sets of most evidence, with how far each is behind the first."""
    rows = ["| causes | estimates | nats behind |", "|:--|:--|--:|"]
    for one in [one for one in ranking if one.plausible][:most]:
        told = "; ".join(
            f"{e.estimate:.3g} ± {e.std:.1g}{'' if e.unit == '1' else ' ' + e.unit}"
            for e in estimates(one)
        )
        rows.append(f"| {one.label} | {told} | {ranking[0].evidence - one.evidence:.1f} |")
    none = next(one for one in ranking if not one.hypotheses)
    return "\n".join([*rows, f"| no cause | | {ranking[0].evidence - none.evidence:.1f} |"])


def errors_table(found):
    """Errors before and after, on circles to the other side and on zig-zags."""
    rows = [
        "| | fitted on port, judged on starboard | fitted on starboard, judged on port |",
        "|:--|--:|--:|",
    ]
    names = [f"turning circle: {name}" for name in SHOWN] + [
        "zig-zag: peak rate",
        "zig-zag: swing",
        "zig-zag: speed",
    ]
    for name in names:
        unit = "deg" if name.endswith("drift") else "%"
        both = [found.held_out[side] for side in ("port", "starboard")]
        rows.append(
            f"| {name} | "
            + " | ".join(f"{o.before[name]:.1f} → {o.after[name]:.1f} {unit}" for o in both)
            + " |"
        )
    return "\n".join(rows)


def manoeuvres_table(found, most=14):
    """What manoeuvres would tell of the sets that fit alike: nats by pair, and the feature that tells most."""
    head = ["manoeuvre, to both sides", "minutes", *(f"{a} / {b}" for a, b in found.pairs)]
    rows = ["| " + " | ".join(head) + " |", "|:--|--:|" + ":--|" * len(found.pairs)]
    sailed = "turning circle with 35 deg at full speed", "zig-zag 20/20 at full speed"
    for one in [
        *found.separations[:most],
        *(one for one in found.separations[most:] if one.manoeuvre in sailed),
    ]:
        told = [f"{nats:.1f}: {_told(one.telling[pair])}" for pair, nats in one.nats.items()]
        rows.append("| " + " | ".join([one.manoeuvre, f"{one.minutes:.0f}", *told]) + " |")
    return "\n".join(rows)


def _told(telling):
    return f"{telling.name} {telling.difference:+.0f} ± {telling.spread:.0f} {telling.unit}"


def whole_table(found):
    """Errors of all trials with the causes fitted to all of them: in-sample."""
    before, after = (errors(found.trials, found.model, c) for c in ({}, changes_of(found.best)))
    return ", ".join(
        f"{name} {before[name]:.1f} → {after[name]:.1f} %"
        for name in ("straight run: speed", "turning circle: speed", "turning circle: rate")
    )


def draw(found, picture=PICTURE):
    """Tracks and headings of three circles: measured, as modelled, with causes fitted on the other side's circles."""
    circles = [t for t in found.trials if t.kind == "turning circle"]
    chosen = [max((t for t in circles if t.side == s), key=lambda t: t.steering) for s in (-1, 1)]
    chosen.append(next(t for t in circles if 0.3 < t.steering < 0.4))
    figure, axes = plt.subplots(2, 3, figsize=(9.0, 6.2), gridspec_kw={"height_ratios": (1.5, 1.0)})
    for (track, heading), trial in zip(axes.T, chosen, strict=True):
        side = "port" if trial.side < 0 else "starboard"
        causes = found.held_out[OTHER[side]].fitted
        (motions,) = sailed([trial], found.model, [{}, causes])
        lines = (("measured", MEASURED, trial.measured), ("as modelled", BEFORE, motions[0]))
        for name, colour, motion in (
            *lines,
            ("with causes fitted on the other side", AFTER, motions[1]),
        ):
            north, east = (motion[:, i] - motion[0, i] for i in (0, 1))
            c, s = np.cos(trial.measured[0, 2]), np.sin(trial.measured[0, 2])
            track.plot(
                trial.side * (c * east - s * north),
                c * north + s * east,
                color=colour,
                label=name,
                lw=1.3,
            )
            turned = np.degrees(trial.side * (motion[:, 2] - motion[0, 2]))
            heading.plot(trial.time, turned, color=colour, lw=1.3)
        angle = np.degrees(np.arcsin(trial.steering))
        track.set(
            aspect="equal", title=f"{angle:.0f}° to {side}", xlabel="to the side of the turn [m]"
        )
        heading.set(xlabel="time, as the way tells it [s]", xlim=(0, 80), ylim=(0, 260))
        heading.axhline(90.0, color="#cccccc", lw=0.6)
        heading.axhline(180.0, color="#cccccc", lw=0.6)
    axes[0, 0].set(ylabel="ahead [m]")
    axes[1, 0].set(ylabel="heading turned [deg]")
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="lower center", ncols=3, frameon=False
    )
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    figure.savefig(picture, dpi=110, metadata={"Software": None})
    plt.close(figure)


def page(found):
    """The page, in Markdown."""
    kinds = [trial.kind for trial in found.trials]
    count = ", ".join(f"{kinds.count(kind)} {kind}s" for kind in dict.fromkeys(kinds))
    steps = "\n".join(
        f"- {one.manoeuvre}, {one.minutes:.0f} minutes: tells {', '.join(f'{a} from {b}' for a, b in one.separates)}"
        for one in found.prescriptions
    )
    return f"""# The trials of 2022 by `shipcosim sea-trials`

*Generated by `docs/generators/write_sea_trials.py`; do not edit. The story is in
[the case](../reports/case-gunnerus-2022.md), the method in [sea trials](../sea-trials.md).*

Found in the log: {count}. Verdict: **{found.verdict}**.

## All trials

{sets_table(found.ranking)}

In-sample: {whole_table(found)}.

## Judged on what was not fitted

Root mean square errors, as modelled → with the causes. Straight runs are fitted on both times;
zig-zags and the circles to the other side are judged on.

{errors_table(found)}

Fitted on port:

{sets_table(found.held_out["port"].ranking, 5)}

Fitted on starboard:

{sets_table(found.held_out["starboard"].ranking, 5)}

![Tracks and headings of three circles](pictures/sea_trials_2022.png)

## What would tell them apart

{steps}

By manoeuvre and pair of sets: the nats by which the right one is expected to lead, and the feature that tells most, by
the second set less by the first. Full, half and slow speed are 1, 0.6 and 0.35 of the largest shaft speed of the
trials, 171 rpm.

{manoeuvres_table(found)}
"""


def studied():
    """The study of the trials, made now."""
    return study(
        LOG,
        read_system(ROOT / "ssp" / "gunnerus_open", fmus=[build_stale(ROOT)]),
        CHANNELS,
        orders=True,
    )


if __name__ == "__main__":
    found = studied()
    PAGE.write_text(page(found), encoding="utf-8")
    draw(found)
