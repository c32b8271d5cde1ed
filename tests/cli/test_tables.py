"""Tables in 80 columns: no number is cut, nothing ends in dots, heads fold between words."""

import pytest

from kshell.cli.tables import components, console, number, table

WIDEST = number(-1.234567e-300)


@pytest.fixture(autouse=True)
def _narrow(monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")


def printed(capsys, *arguments):
    console().print(table(*arguments))
    text = capsys.readouterr().out
    assert "…" not in text
    assert "..." not in text
    assert max(map(len, text.splitlines())) <= 80
    return text


@pytest.mark.parametrize("names", [1, 2, 4])
def test_numbers_are_whole_beside_long_words(names, capsys):
    heads = [f"solve.large_deflection_{k}" for k in range(names)] + ["x, xx", "y, yy", "z, xy"]
    rows = [["a name that goes on and on, without end"] * names + [WIDEST] * 3]
    assert printed(capsys, heads, rows, "Title", 3).count(WIDEST) == 3


def test_four_columns_of_numbers(capsys):
    text = printed(capsys, ["probe", "x", "y", "z", "at t"], [["tip", *[WIDEST] * 4]], "Largest", 4)
    assert text.count(WIDEST) == 4


def test_heads_fold_between_words(capsys):
    rows = [["goods", "", WIDEST, WIDEST, WIDEST]]
    text = printed(capsys, ["case", "combination of", "deflection", "von mises", "utilisation"], rows, "", 3)
    assert "combination" in text


def test_rounding_beside_larger_components_is_zero():
    assert components([1.0, 1e-14, -2.0]) == ["1", "0", "-2"]
    assert components([]) == ["", "", ""]
