"""The pictures of a report, as text that stands in its file."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from io import BytesIO

from kshell.draw.pictures import MODAL, usual_pictures
from kshell.draw.plot import save_picture
from kshell.result.result import Result

DPI = 110
# of every load case after the first
FEW = ("deflection", "von_mises_top", "load_deflection", "history")


@dataclass(frozen=True)
class Image:
    """One picture: its name and its address, which holds the picture itself."""

    name: str
    address: str


def image(result: Result, what: str) -> Image:
    """One picture of a result."""
    stream = BytesIO()
    save_picture(result, what, stream, DPI, small=True)
    return Image(what.replace("_", " "), f"data:image/png;base64,{b64encode(stream.getvalue()).decode()}")


def images(result: Result, few: bool = False) -> list[Image]:
    """The pictures of a result but those of the mesh and of a motion as film; of modes one with all of them."""
    names = [name for name in usual_pictures(result) if name not in ("mesh", "film")]
    if result.analysis in MODAL:
        names = [name for name in names if not name.startswith("mode_")]
    return [image(result, name) for name in names if not few or name in FEW]
