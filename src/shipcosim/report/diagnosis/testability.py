"""Reasons why a log could not have shown some causes: what it lacks."""

from collections.abc import Collection, Mapping, Sequence

from shipcosim.diagnose.finding import VisibleSize
from shipcosim.diagnose.hypotheses.catalogue import read_faults
from shipcosim.diagnose.hypotheses.cause import Cause, placeholders
from shipcosim.report.diagnosis.estimates import shown_unit
from shipcosim.report.diagnosis.words import title
from shipcosim.report.theme.numbers import plain

BY_FORM = (
    "loads of another form than the model's would do the same, and hers have another form; a log of the ship when she "
    "was well, as a reference, tells"
)
UNITS = {
    "speed": "m/s",
    "surge": "m/s",
    "sway": "m/s",
    "wind_speed": "m/s",
    "surge_acceleration": "m/s²",
    "yaw_rate": "°/s",
}


def not_testable_rows(
    names: Sequence[str],
    causes: Mapping[str, Cause],
    facts: Mapping[str, float | None],
    hidden: Collection[str] = (),
) -> list[tuple[str, str, str]]:
    """Rows on causes that this log could not have shown: cause, meaning, what the log lacks.

    Parameters
    ----------
    names : sequence of str
        Of the causes.
    causes : dict of str to Cause
    facts : dict of str to float or None
        What the log has, as from `log_facts`.
    hidden : collection of str
        Causes that another form of the ship's loads hides.
    """
    # What the log has, with units; several logs have nothing of that.
    texts: dict[str, str | None] = {}
    if facts:
        for name, unit in UNITS.items():
            size = facts.get(name)
            texts[name] = None if size is None else f"{plain(size, 2)} {unit}"
        texts["astern_share"] = f"{100.0 * (facts.get('astern_share') or 0.0):.0f} %"
    rows = []
    # The most specific reason wins: of a fault's file, of the load form, of the cause's file.
    faults = read_faults()
    for name in names:
        cause = causes.get(name)
        reason = f"{_reason(cause, texts)}an effect of typical size would not have stood out"
        reason = BY_FORM if name in hidden else reason
        if name in faults and faults[name].why_not_testable:
            reason = faults[name].why_not_testable
        # Meaning of the cause, or of the fault.
        sentence = faults[name].statement.capitalize() if name in faults else ""
        sentence = cause.sentence if cause else sentence
        rows.append((title(name), sentence, reason))
    return rows


def visible_rows(
    sizes: Sequence[VisibleSize], not_testable: Sequence[str] = ()
) -> list[tuple[str, str]]:
    """Each testable cause with the smallest size that would have shown, at every place of the ship.

    Examples
    --------
    >>> from shipcosim.diagnose.finding import VisibleSize
    >>> sizes = {"port": 0.14, "bow": 30.0}
    >>> loss = [VisibleSize("thrust_loss", place, "loss", size, "1", 0.9) for place, size in sizes.items()]
    >>> visible_rows(loss)
    [('Thrust loss', 'port 14 %, bow at no size')]
    """
    rows: dict[str, list[str]] = {}
    for visible in sizes:
        # What only an absurd size would show is said elsewhere, as a cause that cannot be tested.
        if visible.cause in not_testable:
            continue
        # A ratio as a percentage, any other number with its unit.
        if visible.size > visible.largest:
            size = "at no size"
        elif visible.unit in ("1", ""):
            size = f"{plain(100.0 * visible.size, 2)} %"
        else:
            unit, factor = shown_unit(visible.unit, visible.size)
            size = f"{plain(factor * visible.size, 2)} {unit}".replace(" °", "°").rstrip()
        place = [visible.component] if visible.component else []
        # The parameter's name only where the cause has several.
        several = sum(
            other.cause == visible.cause and other.component == visible.component for other in sizes
        )
        name = [visible.parameter.replace("_", " ")] if visible.parameter and several > 1 else []
        rows.setdefault(title(visible.cause), []).append(" ".join([*place, *name, size]))
    return [(cause, ", ".join(texts)) for cause, texts in rows.items()]


def _reason(cause: Cause | None, facts: Mapping[str, str | None]) -> str:
    """What the log lacks to show a cause, with a semicolon; empty if its file does not say."""
    if cause is None or not cause.why_not_testable or not facts:
        return ""
    # The log does not have the channel at all, or too little of it.
    missing = [name for name in placeholders(cause.why_not_testable) if facts[name] is None]
    if missing:
        return f"there is no {missing[0].partition('_')[0]} in the log; "
    return cause.why_not_testable.format_map(facts) + "; "
