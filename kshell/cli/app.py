"""The command that all commands belong to."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Annotated, Any

import typer

from kshell.cli.grouping import flat

# pydantic would look through all packages that are installed for plugins, none of which a command needs
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")

app = typer.Typer(
    name="kshell",
    help="Finite elements for thin plates and shells: a gmsh mesh goes in, a checked answer comes out.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def command(name: str | None = None) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Decorator: a command of kshell, named as its function if nothing else is said; see `flat` for its options."""

    def register(function: Callable[..., None]) -> Callable[..., None]:
        whole = " ".join(
            (function.__doc__ or "").partition("\n\n")[0].split()
        )  # click would cut it to one line
        app.command(name, short_help=whole)(flat(function))
        return function

    return register


def called(arguments: Sequence[str]) -> Any:
    """What runs the arguments: with the one command that they begin with, or with all of them.

    To describe all commands takes as long as to solve a small plate.
    """
    every = app.registered_commands
    mine = [info for info in every if arguments and _name(info) == arguments[0]]
    app.registered_commands = mine or every
    try:
        return typer.main.get_command(app)
    finally:
        app.registered_commands = every


def _name(info: Any) -> str:
    return str(info.name or info.callback.__name__).replace("_", "-")


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
