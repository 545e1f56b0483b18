"""A proposal as a channel file, with the reason of every guess."""

import json
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel

from shipcosim.diagnose.log.names.proposal import Proposal


def channel_file(source: str, proposal: Proposal, remarks: Iterable[str] = ()) -> str:
    """Text of a channel file.

    Parameters
    ----------
    source : str
        The log, for the first line.
    proposal : Proposal
        What its columns are.
    remarks : iterable of str
        How it is read.
    """
    lines = [
        f"# Proposed by `shipcosim channels` for {_line(source)}. Confirm or correct the guesses."
    ]
    lines += [f"# {_line(remark)}" for remark in remarks]
    if form := _entry(proposal.form):
        lines += ["", f"file = {form}"]
    lines.append("")
    width = max((len(_key(guess.role)) for guess in proposal.used), default=0)
    for guess in proposal.used:
        reasons = "; ".join(
            filter(None, (f"guess: {guess.why}" if guess.is_guess else "", *guess.notes))
        )
        plain = guess.channel.model_dump(exclude_defaults=True)
        entry = _text(guess.channel.column) if set(plain) == {"column"} else _entry(guess.channel)
        lines.append(
            f"{_key(guess.role):{width}} = {entry}{f'  # {_line(reasons)}' if reasons else ''}"
        )
    if proposal.unused:
        lines += ["", "# Not used:"]
        lines += [f"# {_line(guess.column)}: {_line(guess.why)}" for guess in proposal.unused]
    return "\n".join(lines) + "\n"


def _line(text: str) -> str:
    """A text without what would end a comment."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def _key(role: str) -> str:
    is_bare = role and all(c.isascii() and (c.isalnum() or c in "_-") for c in role)
    return role if is_bare else _text(role)


def _entry(record: BaseModel) -> str:
    """Entries of a record that differ from its defaults, as an inline table."""
    entries = record.model_dump(exclude_defaults=True)
    return (
        "{" + ", ".join(f"{key} = {_text(value)}" for key, value in entries.items()) + "}"
        if entries
        else ""
    )


def _text(value: Any) -> str:
    if isinstance(value, (tuple, list)):
        return f"[{', '.join(map(_text, value))}]"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
