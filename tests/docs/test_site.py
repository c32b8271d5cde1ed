"""The site: what is made from the program is all there, links lead somewhere, and it builds without a warning."""

import importlib.util
import os
import re
import subprocess
import sys

import pytest

import kshell as ks
from docs.make.pages import pages as made
from docs.make.pages import pictures
from kshell.cli.commands import run
from kshell.scene.keys import blocks
from tests.docs.snippets import DOCS, ROOT, pages

LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


@pytest.fixture(scope="module")
def generated():
    return made()


def test_every_key_and_block_is_in_the_page(generated):
    page = generated["reference/scene.md"]
    for block in blocks().values():
        assert block.head in page or f"### {block.name}\n" in page
        assert all(f"| `{key.name}` |" in page for key in block.keys)


def test_every_command_is_in_the_page(generated, capsys):
    run(["--help"])
    names = re.findall(r"^  ([a-z]+) ", capsys.readouterr().out.partition("Commands:")[2], re.MULTILINE)
    assert len(names) > 10
    assert re.findall(r"^## ([a-z]+)$", generated["reference/commands.md"], re.MULTILINE) == names


def test_verification_and_failures_are_pages(generated):
    assert generated["verification/table.md"].count("\n| ") > 200
    assert generated["verification/failures.md"].count("**What kshell does.**") == 19
    assert "verification/notebooks/plates.md" in generated


def test_every_public_name_is_in_the_page_of_python():
    page = (DOCS / "reference" / "api.md").read_text(encoding="utf-8")
    assert [
        name for name in ks.__all__ if not re.search(rf"\b{name}\b", page) and name != "__version__"
    ] == []


def test_links_lead_somewhere(generated):
    there = {*generated, *pictures(), *(path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.*"))}
    dead = []
    for page in pages():
        folder = page.parent
        for target in LINK.findall(page.read_text(encoding="utf-8")):
            if target.startswith(("http:", "https:", "mailto:")):
                continue
            path = os.path.normpath(folder / target)
            inside = os.path.relpath(path, DOCS).replace(os.sep, "/")
            if not os.path.exists(path) and inside not in there:
                dead.append(f"{page.relative_to(ROOT)}: {target}")
    assert dead == []


@pytest.mark.full
@pytest.mark.skipif(importlib.util.find_spec("mkdocs") is None, reason="needs the extra docs")
def test_the_site_builds_without_a_warning(tmp_path):
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-q", "-d", str(tmp_path / "site")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "site" / "theory" / "koiter.html").read_text(encoding="utf-8")
    assert "<math" in text
    assert "arithmatex" not in text
