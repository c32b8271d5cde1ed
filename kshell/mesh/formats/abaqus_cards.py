"""The keyword cards of an Abaqus or CalculiX deck, with the files it includes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from kshell.errors import InputError
from kshell.mesh.formats.text import text_of

DEEPEST = 50  # files that include each other


@dataclass
class Card:
    """A keyword line with the data lines under it.

    Attributes
    ----------
    keyword : str
        In capitals, with single spaces, without the star.
    parameters : dict of str to str
        Names in capitals; an empty value where the parameter is a word alone.
    rows : list of (str, list of str)
        Where each data line stands, for messages, and its fields without blanks around.
    where : str
        File and line, for messages.
    """

    keyword: str
    parameters: dict[str, str]
    where: str
    rows: list[tuple[str, list[str]]] = field(default_factory=list)

    def name(self, parameter: str) -> str:
        """The value of a parameter that must be there.

        Raises
        ------
        InputError
            If it is not.
        """
        value = self.parameters.get(parameter, "")
        if not value:
            raise InputError(f"{self.where}: *{self.keyword} lacks {parameter}=")
        return value


def cards(path: Path) -> list[Card]:
    """All cards of a deck in order, *INCLUDE and INPUT= followed.

    Raises
    ------
    InputError
        If a file is missing, includes itself, or begins with data.
    """
    found: list[Card] = []
    for card in _cards(path, path.parent, ()):
        if card.keyword == "":
            if found:
                found[-1].rows += card.rows
            elif any(row[0][:1].isdigit() for _, row in card.rows):  # a title may stand there
                raise InputError(
                    f"{card.rows[0][0]}: data before the first keyword. Decks of Abaqus and CalculiX begin with a "
                    "line such as *HEADING or *NODE"
                )
            continue
        found.append(card)
    return found


def _cards(path: Path, folder: Path, above: tuple[Path, ...]) -> Iterator[Card]:
    """Cards of one file; the data before its first keyword are a card without keyword."""
    here = path.resolve()
    if here in above or len(above) > DEEPEST:
        chain = " -> ".join(file.name for file in (*above, here)[-4:])
        raise InputError(f"{path.name}: the files include each other without end: {chain}")
    card = Card("", {}, path.name)
    unfinished = ""
    begin = 0
    for number, line in enumerate(text_of(path).splitlines(), 1):
        text = line.strip()
        if not text or text.startswith("**"):
            continue
        if unfinished or text.startswith("*"):
            begin = begin if unfinished else number
            unfinished += text
            if text.endswith(","):  # goes on in the next line
                continue
            yield from _finished(card, folder, (*above, here))
            card = _card(unfinished, f"{path.name}, line {begin}")
            unfinished = ""
        else:
            card.rows.append((f"{path.name}, line {number}", [word.strip() for word in text.split(",")]))
    yield from _finished(card, folder, (*above, here))
    if unfinished:
        yield from _finished(_card(unfinished, f"{path.name}, line {begin}"), folder, (*above, here))


def _finished(card: Card, folder: Path, above: tuple[Path, ...]) -> Iterator[Card]:
    """A card, followed by the data of the file it names."""
    if card.keyword == "INCLUDE":
        yield from _cards(_file(card, folder, above[-1].parent), folder, above)
        return
    yield card
    if card.keyword in ("NODE", "ELEMENT", "NSET", "ELSET") and card.parameters.get("INPUT"):
        yield from _cards(_file(card, folder, above[-1].parent), folder, above)


def _file(card: Card, *folders: Path) -> Path:
    name = card.name("INPUT").replace("\\", "/")
    for folder in folders:
        if (folder / name).is_file():
            return folder / name
    raise InputError(f"{card.where}: the included file {name} is not found. Put it beside the deck")


def _card(line: str, where: str) -> Card:
    keyword, *words = _fields(line[1:])
    parameters = {}
    for word in words:
        name, _, value = word.partition("=")
        if name.strip():
            parameters[" ".join(name.upper().split())] = value.strip().strip("\"'").strip()
    return Card(" ".join(keyword.upper().split()), parameters, where)


def _fields(line: str) -> list[str]:
    """Fields between commas; a comma in quotes divides nothing."""
    if '"' not in line:
        return line.split(",")
    fields, quoted = [""], False
    for sign in line:
        quoted ^= sign == '"'
        if sign == "," and not quoted:
            fields.append("")
        else:
            fields[-1] += sign
    return fields
