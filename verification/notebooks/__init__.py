"""Notebooks, each made from the Python script beside it."""
