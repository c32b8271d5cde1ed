"""A result in a notebook: picture, probes and warnings."""

from __future__ import annotations

import base64
import io
from html import escape
from typing import TYPE_CHECKING

from kshell.values.html import html_list, html_table

if TYPE_CHECKING:
    from kshell.result.result import Result


def page(result: Result) -> str:
    """HTML of a result."""
    stream = io.BytesIO()
    result.plot().savefig(stream, format="png", dpi=72)
    picture = base64.b64encode(stream.getvalue()).decode("ascii")
    rows = [
        [name, *(f"{part:.6g}" for part in values["u"])]
        for name, values in result.probes.items()
        if "u" in values
    ]
    probes = html_table(["probe", "u_x", "u_y", "u_z"], rows) if rows else ""
    image = f'<img alt="deflection" src="data:image/png;base64,{picture}">'
    return f"<p>{escape(repr(result))}</p>{image}{probes}{html_list(result.warnings, 'Warnings')}"
