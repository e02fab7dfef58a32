"""The ``pinwarp`` command: opens the window, unless its first word is another command."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import Any

import typer
import typer.main
from typer.core import TyperCommand, TyperGroup

from pinwarp.cli.open import OpenWindow, Version, make_open
from pinwarp.cli.telling import BAD_USAGE, INTERRUPTED, tell_error
from pinwarp.core.errors import PinwarpError, words_of

OPEN = "open"
# Each in the module of its name, which is loaded when it is asked for: the window needs none.
LATER = ("warp", "check", "repeat", "suggest", "refine", "convert", "batch", "model")


class Command(TyperCommand):
    """A command whose help tells no type of flags: they take no value."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write its help."""
        _without_types(self.get_params(ctx))
        super().format_help(ctx, formatter)


class Commands(TyperGroup):
    """Commands, of which ``open`` need not be said; all errors are told on one line."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write its help."""
        _without_types(self.get_params(ctx))
        super().format_help(ctx, formatter)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put in the command where the first word is none."""
        if not args or args[0] not in (*self.list_commands(ctx), "--help", "--version"):
            args = [OPEN, *args]
        return super().parse_args(ctx, args)

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all commands, loaded or not."""
        del ctx
        return [OPEN, *LATER]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command, loaded now where it is not yet."""
        if cmd_name in LATER and cmd_name not in self.commands:
            alone = typer.Typer(add_completion=False, rich_markup_mode="rich")
            function = getattr(import_module(f"pinwarp.cli.{cmd_name}"), cmd_name)
            alone.command(cls=Command)(function)
            self.commands[cmd_name] = typer.main.get_command(alone)
        return super().get_command(ctx, cmd_name)

    def invoke(self, ctx: Any) -> Any:
        """Run the command; what was raised for the user is told, not traced."""
        try:
            return super().invoke(ctx)
        except typer.BadParameter as error:
            # Whose value it is, is said before; that it is one says nothing.
            error.message = error.message.replace("Value error, ", "")
            raise
        except BrokenPipeError:
            # Whoever read what is printed has enough: no mistake of anybody's.
            raise
        except (PinwarpError, OSError) as error:
            tell_error(words_of(error))
            raise typer.Exit(BAD_USAGE) from None
        except KeyboardInterrupt:
            tell_error("Interrupted.")
            raise typer.Exit(INTERRUPTED) from None


def _without_types(options: Iterable[Any]) -> None:
    for option in options:
        if getattr(option, "is_flag", False):
            # The help of typer asks for it, and has no other way to leave it out.
            vars(option)["display_type_rich"] = _no_type


def _no_type(ctx: Any) -> None:
    del ctx


def make_app(open_window: OpenWindow) -> typer.Typer:
    """Return the command; the window is handed in, so that this module needs no Qt."""
    app = typer.Typer(
        cls=Commands,
        add_completion=False,
        rich_markup_mode="rich",
        subcommand_metavar="[SOURCE DESTINATION | SESSION | COMMAND ...]",
    )

    @app.callback()
    def pinwarp_(
        version: Version = False,
    ) -> None:
        """Pair landmarks on two bones and warp one into the other.

        Without a command the window opens: on two meshes, on a session, or empty.
        See [bold]pinwarp open --help[/bold] for its options.
        """
        del version  # told before anything else

    app.command(OPEN, cls=Command)(make_open(open_window))
    return app
