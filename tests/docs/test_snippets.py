"""Every program, command and file in README.md and in docs/ works."""

import shutil
import sys

import matplotlib.pyplot as plt
import pytest

from tests.docs.snippets import DOCS, ROOT, follow, pages, snippets

RUNNABLE = [page for page in pages() if any(one.run and one.kind != "text" for one in snippets(page))]
LONG = [page for page in RUNNABLE if any(one.full and one.run for one in snippets(page))]


def named(page):
    return page.relative_to(ROOT).with_suffix("").as_posix()


@pytest.fixture(autouse=True)
def world(tmp_path, monkeypatch):
    """A folder with what the pages find beside them."""
    shutil.copytree(ROOT / "meshes", tmp_path / "meshes")
    for path in (DOCS / "tutorials" / "panel").iterdir():
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)  # put back what `run` sets
    yield
    plt.close("all")


@pytest.mark.parametrize("page", RUNNABLE, ids=named)
def test_pages_work(page):
    assert list(follow(page, full=False)) == []


@pytest.mark.full
@pytest.mark.parametrize("page", LONG, ids=named)
def test_pages_work_in_full(page):
    assert list(follow(page, full=True)) == []


def test_blocks_are_found():
    assert {"tutorials/panel", "index"} <= {named(page).removeprefix("docs/") for page in RUNNABLE}
    kinds = [one.kind for page in pages() for one in snippets(page)]
    assert min(kinds.count(kind) for kind in ("sh", "python", "toml")) > 5
