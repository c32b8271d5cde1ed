"""The command that all commands belong to."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import typer

from kshell.cli.grouping import flat

# pydantic would look through all packages that are installed for plugins, none of which a command needs
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")

COMPLETING = "_KSHELL_COMPLETE"  # set where a shell asks for what may come next

app = typer.Typer(
    name="kshell",
    help="Finite elements for thin plates and shells: a gmsh mesh goes in, a checked answer comes out.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


@dataclass(frozen=True)
class _Command:
    """A command before its options are looked at, which takes a while."""

    name: str
    function: Callable[..., None]

    @property
    def words(self) -> str:
        """The first lines of its help, which click would cut to one."""
        return " ".join((self.function.__doc__ or "").partition("\n\n")[0].split())

    def without_options(self) -> Callable[[], None]:
        """For a list of commands."""

        def listed() -> None:
            """Nothing."""

        return listed


_commands: list[_Command] = []


def command(name: str | None = None) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Decorator: a command of kshell, named as its function if nothing else is said; see `flat` for its options."""

    def register(function: Callable[..., None]) -> Callable[..., None]:
        _commands.append(_Command(name or function.__name__.replace("_", "-"), function))
        return function

    return register


def called(arguments: Sequence[str]) -> Any:
    """What runs the arguments: with the one command that they begin with, or with all of them.

    To describe all commands takes as long as to solve a small plate: for the list of them their options are left out.
    """
    mine = [each for each in _commands if arguments and each.name == arguments[0]]
    listed = list(arguments) in ([], ["--help"]) and COMPLETING not in os.environ
    return _group(mine or _commands, options=not listed)


def every_command() -> Any:
    """The group of all commands with their options."""
    return _group(_commands, options=True)


def _group(commands: Sequence[_Command], options: bool) -> Any:
    app.registered_commands = []
    for each in commands:
        function = flat(each.function) if options else each.without_options()
        app.command(each.name, short_help=each.words)(function)
    return typer.main.get_command(app)


def _print_version(wanted: bool) -> None:
    if wanted:
        from kshell.version import __version__

        typer.echo(f"kshell {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass
