"""The pages of verification: the table of cases, and the gallery of failures."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from docs.make.markdown import in_table
from kshell.verify.cases import all_cases
from kshell.verify.cases.case import Case
from verification.failures import GALLERY

ROOT = Path(__file__).parents[2]

TABLE = """# Verification

Cases with a known answer, run by `kshell verify` on your machine (`--quick`: each once; `--out DIR`: charts and a
page). A case is a scene; its values are compared with references that are exact or known to more digits than are
compared. What is allowed is about twice the error that was measured when the case was recorded, with the number of
unknowns that it took: a change that loses digits or needs more unknowns fails.

{summary}

![Errors over what is allowed](suite/margins.png)

![Observed rates of convergence beside the expected ones](suite/rates.png)

## Cases

The column of allowed errors has the best method of each element: the largest relative error of any value, and how many
unknowns.
"""

FAILURES = """# Where methods fail

Places where finite elements of plates and shells go wrong without a word, each with numbers, a picture, and what kshell
does about it. `python -m verification.failures locking` measures one anew; tests hold them to what is written.
"""


def table_page() -> str:
    """Markdown."""
    readme = (ROOT / "verification" / "README.md").read_text(encoding="utf-8")
    found = re.search(r"<!-- summary:.*?-->\n(.*?)<!-- end", readme, re.DOTALL)
    assert found is not None, "verification/README.md has no summary"
    cases = all_cases()
    families: dict[str, list[Case]] = {}
    for case in cases:
        families.setdefault(case.id.partition(".")[0], []).append(case)
    return "\n".join([TABLE.format(summary=found[1].strip()), *_families(families)])


def _families(families: dict[str, list[Case]]) -> Iterator[str]:
    for name, cases in families.items():
        yield f"### {name}\n"
        yield "| case | what | source | allowed error (unknowns) |\n|---|---|---|---|"
        for case in cases:
            yield f"| {case.id} | {in_table(case.description)} | {in_table(case.source)} | {'; '.join(_best(case))} |"
        yield ""


def _best(case: Case) -> Iterator[str]:
    """The most accurate run of each element."""
    best: dict[str, tuple[float, str]] = {}
    for run, errors in case.allowed.items():
        values = [error for what, error in errors.items() if not what.startswith("rate ")]
        element = run.partition("-")[0].rstrip("123")
        if values and (element not in best or max(values) < best[element][0]):
            best[element] = max(values), run
    for element, (error, run) in best.items():
        yield f"{element} {error:.0e} ({case.most_unknowns[run]})"


def failures_page() -> str:
    """Markdown."""
    parts = [FAILURES]
    for entry in GALLERY.values():
        parts.append(f"## {entry.title}\n\n{in_table(entry.what)}\n")
        parts.append(f"![{entry.title}](failures/{entry.id}.png)\n")
        parts.append(f"**What kshell does.** {in_table(entry.kshell)}\n")
    return "\n".join(parts)
