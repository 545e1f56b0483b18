"""Errors and messages of an FMU, as the host reads them."""

import os
import traceback
from pathlib import Path
from typing import NamedTuple

CODE = Path(__file__).parents[2]
SHELL = str(Path(__file__).parent)
STATUSES = ("ok", "warning", "discard", "error")


class FmuError(Exception):
    """Reason why an FMU cannot go on. The host's logger reads its text as a printf format."""

    def __repr__(self) -> str:
        return str(self).replace("%", "%%")


class Message(NamedTuple):
    """Message to the logger of the host; its text is a printf format.

    Attributes
    ----------
    status : int
        Status of FMI: place in `STATUSES`.
    category : str
        Log category, as the model description lists them.
    msg : str
        Text.
    """

    status: int
    category: str
    msg: str


def message_of(text: str, status: str) -> Message:
    """Message of a text, with percent signs doubled.

    Parameters
    ----------
    text : str
        Text.
    status : str
        One of `STATUSES`.

    Returns
    -------
    Message
    """
    return Message(
        STATUSES.index(status), f"logStatus{status.capitalize()}", text.replace("%", "%%")
    )


def text_of(error: BaseException) -> str:
    """Text of an error: that of an `FmuError`, else the FMU's traceback.

    Parameters
    ----------
    error : BaseException
        The error.

    Returns
    -------
    str
    """
    return str(error) if isinstance(error, FmuError) else f"exception\n{_traceback(error)}"


def _traceback(error: BaseException) -> str:
    """Traceback without frames of host and shell, with paths relative to the FMU's folder."""
    # Skip the outer frames, which belong to host and shell.
    trace = error.__traceback__
    while trace and trace.tb_next and not _is_fmus_own(trace.tb_frame.f_code.co_filename):
        trace = trace.tb_next
    lines = "".join(traceback.format_exception(type(error), error, trace)).rstrip()
    return lines.replace(str(CODE) + os.sep, "")


def _is_fmus_own(file: str) -> bool:
    return file.startswith(str(CODE)) and not file.startswith(SHELL)
