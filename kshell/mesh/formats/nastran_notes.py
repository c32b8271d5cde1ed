"""What a Nastran file says besides its mesh, in words: properties and materials, and what is not read."""

from __future__ import annotations

from dataclasses import dataclass, field

from kshell.mesh.formats.nastran_cards import Entry
from kshell.mesh.words import quoted

# entries that say nothing of the model, or belong to others
_SILENT = (
    "PARAM", "MDLPRM", "EIGR", "EIGRL", "EIGB", "EIGC", "PLOTEL", "PLOTEL3", "PLOTEL4", "NLPARM", "NLPCI", "TSTEP",
    "TSTEPNL", "FREQ", "FREQ1", "FREQ2", "FREQ3", "FREQ4", "FREQ5", "TABLED1", "TABLED2", "TABLED3", "TABLED4",
    "TABLEM1", "TABLES1", "TABLEM2", "TABDMP1", "DTI", "DMI", "PSHELL", "PCOMP", "PCOMPG", "MAT1", "MAT8", "SPCADD",
    "LOADADD", "SUPORT", "SUPORT1", "ASET", "ASET1", "OMIT", "OMIT1", "QSET", "QSET1", "USET", "USET1", "SPOINT",
    "PBAR", "PBARL", "PBEAM", "PBEAML", "PROD", "PTUBE", "PSOLID", "PLPLANE", "PBUSH", "PELAS", "PDAMP", "PGAP",
)  # fmt: skip


@dataclass
class Notes:
    """Gathers words from the entries that do not describe the mesh."""

    said: list[str] = field(default_factory=list)
    _properties: dict[int, Entry] = field(default_factory=dict)
    _materials: dict[int, Entry] = field(default_factory=dict)
    _held: list[str] = field(default_factory=list)
    _unread: list[str] = field(default_factory=list)

    def take(self, entry: Entry) -> None:
        """Remember an entry."""
        if entry.name in ("PSHELL", "PCOMP", "PCOMPG"):
            self._properties[entry.whole(0)] = entry
        elif entry.name in ("MAT1", "MAT8"):
            self._materials[entry.whole(0)] = entry
        if entry.name not in _SILENT and entry.name not in self._unread:
            self._unread.append(entry.name)

    def held(self, name: str, components: str) -> None:
        """Remember which freedoms the grid points of a group are held in."""
        self._held.append(f"'{name}' in {components}")

    def words(self) -> list[str]:
        """Notes for the mesh."""
        notes = list(self.said)
        for number, entry in self._properties.items():
            notes.append(f"the file gives property {number} {self._property(entry)}")
        if self._held:
            more = f" and {len(self._held) - 12} more" if len(self._held) > 12 else ""
            notes.append(f"the file holds the freedoms of {', '.join(self._held[:12])}{more}")
        if self._unread:
            notes.append(f"not read, to be said in the scene where it matters: {quoted(self._unread, 30)}")
        return notes

    def _property(self, entry: Entry) -> str:
        if entry.name == "PSHELL":
            thickness = f"thickness {entry.word(2)}" if entry.word(2) else "no thickness"
            return thickness + self._material(entry.word(1))
        width = 8 if entry.name == "PCOMPG" else 4
        first = 9 if entry.name == "PCOMPG" else 8
        layers, material, thickness = [], "", ""
        for at in range(first, len(entry.fields), width):
            material, thickness = entry.word(at) or material, entry.word(at + 1) or thickness
            if any(entry.fields[at : at + 3]):
                layers.append(f"{thickness}{self._material(material)} at {entry.word(at + 2) or 0} degrees")
        mirrored = ", and the same mirrored" if entry.word(7).upper() == "SYM" else ""
        more = f" and {len(layers) - 6} more" if len(layers) > 6 else ""
        return f"layers {'; '.join(layers[:6])}{more}{mirrored}"

    def _material(self, word: str) -> str:
        if not word:
            return ""
        entry = self._materials.get(int(word)) if word.isdigit() else None
        if entry is None:
            return f", material {word}"
        names = ("E", "G", "nu", "density") if entry.name == "MAT1" else ("E1", "E2", "nu12", "G12")
        values = [f"{name} = {entry.word(k)}" for k, name in enumerate(names, 1) if entry.word(k)]
        return f", material {word} ({', '.join(values)})"
