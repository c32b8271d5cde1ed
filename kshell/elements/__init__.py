"""Plate elements: Morley and Argyris."""

from kshell.elements.affine import AffineTriangles
from kshell.elements.argyris import ElementArgyris
from kshell.elements.base import PlateElement
from kshell.elements.morley import ElementMorley

__all__ = ["AffineTriangles", "ElementArgyris", "ElementMorley", "PlateElement"]
