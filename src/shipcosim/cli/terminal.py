"""The one way of the commands to the terminal: no control character of a file or an FMU gets there."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import typer

from shipcosim.errors import CONTROLS, printable

if TYPE_CHECKING:
    from rich.console import Console


def make_console(*, stderr: bool = False, **options: Any) -> Console:
    """Rich console on stdout or stderr that shows control characters as escapes; options as of rich."""
    from rich.console import Console, RenderHook
    from rich.segment import Segment

    class Printable:
        """What rich shows, with the texts in it made printable; styles and cursor movements of rich stay."""

        def __init__(self, shown):
            self.shown = shown

        def __rich_console__(self, console, options):
            for segment in console.render(self.shown, options):
                is_text = not segment.control
                yield Segment(printable(segment.text), segment.style) if is_text else segment

    class MakePrintable(RenderHook):
        def process_renderables(self, renderables):
            return [Printable(renderable) for renderable in renderables]

    # Names of files and components may look like markup or emoji of rich: they stay text.
    plain = {"highlight": False, "markup": False, "emoji": False}
    console = Console(stderr=stderr, **{**plain, **options})
    console.push_render_hook(MakePrintable())
    return console


def say(text: object, *, err: bool = False) -> None:
    """Print a line of text on stdout or stderr."""
    typer.echo(printable(str(text)), err=err)


def say_next(steps: Mapping[str, str]) -> None:
    """Print how to go on: commands, and in a column behind them what each does."""
    widest = max(len(command) for command, does in steps.items() if does)
    lines = [f"  {command:<{widest}}   {does}".rstrip() for command, does in steps.items()]
    say("\n".join(["\nGo on with:", *lines]))


def say_json(content: object) -> None:
    """Print as JSON on stdout."""
    text = json.dumps(content, indent=2, ensure_ascii=False)
    # JSON has escapes of its own for characters that control a terminal.
    typer.echo(CONTROLS.sub(lambda match: json.dumps(match[0])[1:-1], text))
