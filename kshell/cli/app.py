"""The command that all commands belong to."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from kshell.cli.grouping import flat

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
