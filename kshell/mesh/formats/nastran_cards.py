"""The bulk data entries of a Nastran file: fields in small (8 columns), large (16 columns) and free format.

Source: MSC Nastran Quick Reference Guide, "Format of Bulk Data Entries".
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from kshell.errors import InputError
from kshell.mesh.formats.text import real, text_of, whole

DEEPEST = 50  # files that include each other
_NAME = re.compile(r"^[A-Za-z][A-Za-z0-9]*\*?$")
# names of properties in the comments of HyperMesh, Femap and Patran
_NAMES = (
    re.compile(r'^\$HMNAME\s+PROP\s+(\d+)\s*"([^"]+)"'),
    re.compile(r"^\$\s*Femap Property (\d+)\s*:\s*(.+?)\s*$"),
    re.compile(r'^\$\s*Pset:\s*"([^"]+)"\s*will be imported as:\s*"[a-z]+\.(\d+)"'),
)


@dataclass
class Entry:
    """A bulk data entry: its name in capitals and its fields, without the name and the marks of continuation."""

    name: str
    fields: list[str]
    where: str

    def word(self, number: int) -> str:
        """Field `number`, 0 for the first after the name; empty where there is none."""
        return self.fields[number] if number < len(self.fields) else ""

    def whole(self, number: int, default: int | None = None) -> int:
        """A field as a whole number.

        Raises
        ------
        InputError
            If it is none, or empty without a default.
        """
        word = self.word(number)
        if not word and default is not None:
            return default
        return whole(word, f"{self.where}, {self.name}")

    def real(self, number: int, default: float = 0.0) -> float:
        """A field as a number."""
        word = self.word(number)
        return real(word, f"{self.where}, {self.name}") if word else default

    def numbers(self, first: int) -> list[int]:
        """The whole numbers from field `first` on, THRU and BY spelled out, empty fields left out."""
        words = [word.upper() for word in self.fields[first:] if word]
        found: list[int] = []
        at = 0
        while at < len(words):
            if words[at] == "THRU" and found and at + 1 < len(words):
                step = 1
                end = whole(words[at + 1], self.where)
                if at + 3 < len(words) and words[at + 2] == "BY":
                    step = whole(words[at + 3], self.where)
                    at += 2
                if step < 1 or end < found[-1]:
                    raise InputError(f"{self.where}, {self.name}: {found[-1]} THRU {end} gives nothing")
                found += range(found[-1] + step, end + 1, step)
                if found[-1] != end:
                    found.append(end)
                at += 2
            else:
                found.append(whole(words[at], f"{self.where}, {self.name}"))
                at += 1
        return found


@dataclass
class Bulk:
    """The entries of a file, and the names its comments give to properties."""

    entries: list[Entry]
    names: dict[int, str]


def bulk(path: Path) -> Bulk:
    """Bulk data of a file, INCLUDE followed. Without BEGIN BULK the whole file is bulk data.

    Raises
    ------
    InputError
        If a file is missing or includes itself, or an entry is of a form that is not read.
    """
    lines = list(_lines(path, path.parent, ()))
    names: dict[int, str] = {}
    for _, line in lines:
        for number, pattern in enumerate(_NAMES):
            match = pattern.match(line) if line.startswith("$") else None
            if match:
                tag, name = (match[2], match[1]) if number == 2 else (match[1], match[2])
                names[int(tag)] = name
    begin = [k for k, (_, line) in enumerate(lines) if re.match(r"\s*BEGIN\b", line, re.IGNORECASE)]
    if len(begin) > 1:
        raise InputError(f"{lines[begin[1]][0]}: several bulk data sections (superelements) are not read")
    entries: list[Entry] = []
    last = ""  # mark of continuation at the end of the line before
    for where, line in lines[begin[0] + 1 if begin else 0 :]:
        text = line.partition("$")[0].expandtabs(8).rstrip()
        if not text.strip():
            continue
        if text.split()[0].upper() == "ENDDATA":
            break
        first, fields, mark = _split(text, where)
        if first == "" or first[0] in "+*":
            if not entries:
                raise InputError(f"{where}: a continuation of nothing")
            if not _follows(last, first):
                raise InputError(
                    f"{where}: the continuation '{first}' does not follow the line that ends in '{last}': write the "
                    "file with continuations in order"
                )
            entry = entries[-1]
            entry.fields += fields
        elif first.startswith("="):
            raise InputError(f"{where}: replication of entries (=) is not read. Write the entries out")
        elif not _NAME.match(first):
            raise InputError(f"{where}: {text[:40]!r} is no bulk data entry")
        else:
            entries.append(Entry(first.rstrip("*").upper(), fields, where))
        last = mark
    return Bulk(entries, names)


def _follows(end: str, begin: str) -> bool:
    """Whether the mark at the end of a line is that at the begin of the next; their first signs may differ."""
    one, other = end.strip("+*").upper(), begin.strip("+*").upper()
    return not one or not other or one == other or end[1:].upper() == begin[1:].upper()


def _split(text: str, where: str) -> tuple[str, list[str], str]:
    """First field, the data fields (8, or 4 large ones), and the mark of continuation of a line."""
    if "," in text and (text[:8].strip() or "," in text[:8]) and text[:6].upper() != "DEQATN":
        words = [word.strip() for word in text.split(",")]
        words = (
            words[0].split(None, 1) + words[1:] if words[0] else words
        )  # blanks may part the name from a field
        while len(words) > 10 and not words[-1]:
            words.pop()
        first = words[0]
        number = 4 if first.endswith("*") or first.startswith("*") else 8
        if len(words) > number + 2:
            raise InputError(
                f"{where}: {len(words)} fields in a line of free format instead of {number + 2} at most"
            )
        fields, mark = words[1 : number + 1], "".join(words[number + 1 :])
        if fields and fields[-1].startswith("+") and not fields[-1][1:2].isdigit() and fields[-1][1:2] != ".":
            fields, mark = fields[:-1], fields[-1]
        return first, fields + [""] * (number - len(fields)), mark
    first = text[:8].strip()
    if "*" in first:
        fields = [text[k : k + 16].strip() for k in (8, 24, 40, 56)]
    else:
        fields = [text[k : k + 8].strip() for k in range(8, 72, 8)]
    return first, fields, text[72:80].strip()


def _lines(path: Path, folder: Path, above: tuple[Path, ...]) -> Iterator[tuple[str, str]]:
    """Lines with the words that say where they are; included files in their place."""
    here = path.resolve()
    if here in above or len(above) > DEEPEST:
        chain = " -> ".join(file.name for file in (*above, here)[-4:])
        raise InputError(f"{path.name}: the files include each other without end: {chain}")
    named, where = "", ""
    for number, line in enumerate(text_of(path).splitlines(), 1):
        if named or re.match(r"\s*INCLUDE\b", line, re.IGNORECASE):
            where = where if named else f"{path.name}, line {number}"
            named += line.partition("$")[0].strip() if not named.strip() else line.strip()
            if named.count("'") == 1 or named.count('"') == 1:  # a long name goes on in the next line
                continue
            yield from _lines(_file(named, folder, here.parent, where), folder, (*above, here))
            named = ""
        else:
            yield f"{path.name}, line {number}", line


def _file(statement: str, folder: Path, own: Path, where: str) -> Path:
    name = statement.strip()[7:].strip().strip("'\"").replace("\\", "/")
    for place in (folder, own):
        if (place / name).is_file():
            return place / name
    raise InputError(f"{where}: the included file {name} is not found. Put it beside the deck")
