"""What mkdocs calls while it builds the site: pages made from the program are added, formulas become MathML."""

from __future__ import annotations

import html
import re
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.DOTALL)
DISPLAY = re.compile(r'<div class="arithmatex">\s*\\\[(.*?)\\\]\s*</div>', re.DOTALL)


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are made from the program, and the pictures in them."""
    from mkdocs.structure.files import File

    if str(ROOT) not in sys.path:  # mkdocs runs this file alone
        sys.path.insert(0, str(ROOT))
    from docs.make.pages import pages, pictures

    for path, text in pages().items():
        files.append(File.generated(config, path, content=text))
    for path, source in pictures().items():
        content = source if isinstance(source, bytes) else source.read_bytes()
        files.append(File.generated(config, path, content=content))
    return files


def on_page_content(content: str, page: Any, config: Any, files: Any) -> str:
    """Formulas between dollars as MathML, which browsers show without any program."""
    from latex2mathml.converter import convert

    def mathml(display: str, around: str) -> Any:
        return lambda found: around.format(convert(html.unescape(found[1].strip()), display=display))

    inline = INLINE.sub(mathml("inline", "{}"), content)
    return DISPLAY.sub(mathml("block", '<div class="formula">{}</div>'), inline)
