"""All pages that are made from the program, as Markdown by their path in the site, and the pictures in them."""

from __future__ import annotations

from pathlib import Path

from docs.make.commands import commands_page
from docs.make.keys import scene_page
from docs.make.notebooks import notebook_pages
from docs.make.verification import failures_page, table_page

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "verification" / "pictures"


def pages() -> dict[str, str]:
    """Path to Markdown."""
    texts, _ = notebook_pages()
    return {
        "reference/scene.md": scene_page(),
        "reference/commands.md": commands_page(),
        "verification/table.md": table_page(),
        "verification/failures.md": failures_page(),
        **texts,
    }


def pictures() -> dict[str, Path | bytes]:
    """Path to the file, or its bytes."""
    _, drawn = notebook_pages()
    found = {
        f"verification/{path.relative_to(PICTURES).as_posix()}": path for path in PICTURES.rglob("*.png")
    }
    return {**found, **drawn}
