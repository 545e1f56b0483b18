"""What a check of a log finds."""

from dataclasses import dataclass, field

__all__ = ["Estimate", "Finding"]


@dataclass(frozen=True)
class Estimate:
    """A number with its standard deviation and unit."""

    estimate: float
    std: float
    unit: str


@dataclass(frozen=True)
class Finding:
    """A fault of a log, or an ordinary defect of it.

    Parameters
    ----------
    cause : str
        A cause of the contract (`clock`, `gap`, `frame`, `channel_swap`, `sign`, `heading_wrap`, `navigation_lag`,
        `velocity_scale`), or an ordinary defect: `unordered`, `repeated`, `uneven`, `missing`, `outlier`, `stale`,
        `clipped`, `jump`.
    channels : tuple of str
        Roles it concerns; `time` for the time stamps.
    segments : tuple of (float, float)
        From, to, by the log's clock. [s] Empty: the whole log.
    parameters : dict of str to Estimate
        Its size.
    probability : float
        That it is this, given that causes are rare and were searched for.
    severity : str
        ``"fault"``, or ``"remark"`` for what is normal in logs and is handled.
    sentence : str
        For readers.
    rivals : tuple of str
        What would explain the data nearly as well.
    rows : int
        Rows concerned, for defects of single samples.
    transform : str
        Name of the change of the channels that undoes it (see `mislabel.MISLABELS`); empty where there is none.
    kind : str
        ``"data"``.
    """

    cause: str
    channels: tuple[str, ...]
    segments: tuple[tuple[float, float], ...] = ()
    parameters: dict[str, Estimate] = field(default_factory=dict)
    probability: float = 1.0
    severity: str = "fault"
    sentence: str = ""
    rivals: tuple[str, ...] = ()
    rows: int = 0
    transform: str = ""
    kind: str = "data"
