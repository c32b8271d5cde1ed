"""What an Abaqus deck says besides its mesh, in words: sections and materials, and what is not read."""

from __future__ import annotations

from dataclasses import dataclass, field

from kshell.mesh.formats.abaqus_cards import Card
from kshell.mesh.words import quoted

# cards that say nothing of the model: titles, output, control of the solution
_SILENT = (
    "HEADING", "PREPRINT", "STEP", "END STEP", "STATIC", "FREQUENCY", "BUCKLE", "DYNAMIC", "MODAL DYNAMIC", "RESTART",
    "OUTPUT", "NODE OUTPUT", "ELEMENT OUTPUT", "NODE PRINT", "EL PRINT", "NODE FILE", "EL FILE", "CONTACT FILE",
    "CONTACT PRINT", "CONTACT OUTPUT", "ENERGY OUTPUT", "ENERGY PRINT", "ENERGY FILE", "PRINT", "FILE FORMAT",
    "MONITOR", "CONTROLS", "SOLVER CONTROLS", "TIME POINTS", "SECTION PRINT", "SECTION FILE", "WAVEFRONT MINIMIZATION",
    "FILE OUTPUT", "CONTENTS", "SURFACE", "AMPLITUDE", "MATERIAL", "ELASTIC", "DENSITY", "SHELL SECTION",
    "SHELL GENERAL SECTION", "DISTRIBUTION TABLE", "DISTRIBUTION", "NO PRINT", "INCREMENTATION OUTPUT", "VISUALIZATION",
    "STEADY STATE DYNAMICS", "HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT", "VIEWFACTOR", "CONTACT PAIR OUTPUT",
)  # fmt: skip


@dataclass
class _Material:
    name: str
    elastic: list[str] = field(default_factory=list)
    density: str = ""
    kind: str = ""


@dataclass
class Notes:
    """Gathers words from the cards that do not describe the mesh."""

    materials: dict[str, _Material] = field(default_factory=dict)
    sections: list[str] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)
    _material: _Material | None = None
    _sections: list[tuple[str, str, str]] = field(default_factory=list)  # set, thickness in words, material

    def take(self, card: Card) -> None:
        """Remember a card."""
        word = card.keyword
        row = card.rows[0][1] if card.rows else []
        if word == "MATERIAL":
            name = card.parameters.get("NAME", "")
            self._material = self.materials.setdefault(name.casefold(), _Material(name))
        elif word == "ELASTIC" and self._material is not None:
            self._material.elastic = [value for value in row if value]
            self._material.kind = card.parameters.get("TYPE", "ISOTROPIC").upper()
        elif word == "DENSITY" and self._material is not None:
            self._material.density = row[0] if row else ""
        elif word in ("SHELL SECTION", "SHELL GENERAL SECTION"):
            self._section(card)
        if word not in _SILENT and word not in self.unread:
            self.unread.append(word)

    def _section(self, card: Card) -> None:
        rows = [row for _, row in card.rows]
        material = card.parameters.get("MATERIAL", "")
        if "COMPOSITE" in card.parameters:
            layers = [
                f"{row[0]} of '{row[2] if len(row) > 2 else material}'"
                + (f" at {row[3]} degrees" if len(row) > 3 and row[3] not in ("", "0", "0.") else "")
                for row in rows
            ]
            words = f"layers {', '.join(layers[:8])}" + (
                f" and {len(layers) - 8} more" if len(layers) > 8 else ""
            )
        else:
            words = f"thickness {rows[0][0]}" if rows and rows[0][0] else "no thickness"
        if card.parameters.get("OFFSET"):
            words += f", offset {card.parameters['OFFSET']}"
        if "NODAL THICKNESS" in card.parameters:
            words = "thickness at nodes, not read"
        self._sections.append((card.parameters.get("ELSET", ""), words, material))

    def words(self) -> list[str]:
        """Notes for the mesh."""
        notes = []
        for on, words, material in self._sections:
            text = f"the deck gives '{on}' {words}"
            known = self.materials.get(material.casefold())
            if material:
                text += f", material '{material}'"
            notes.append(text + (f" ({_constants(known)})" if known and _constants(known) else ""))
        if not self._sections:
            notes += [
                f"the deck gives material '{m.name}' ({_constants(m)})"
                for m in self.materials.values()
                if _constants(m)
            ]
        if self.unread:
            unread = quoted([f"*{word}" for word in self.unread], 30)
            notes.append(f"not read, to be said in the scene where it matters: {unread}")
        return notes


def _constants(material: _Material) -> str:
    texts = []
    if material.elastic and material.kind in ("ISOTROPIC", "ISO"):
        texts += [f"{name} = {value}" for name, value in zip(("E", "nu"), material.elastic, strict=False)]
    elif material.elastic:
        texts.append(f"{material.kind.lower()} {', '.join(material.elastic)}")
    if material.density:
        texts.append(f"density {material.density}")
    return ", ".join(texts)
