"""Expressions, checked numbers and names: what scene, material and geometry share."""
