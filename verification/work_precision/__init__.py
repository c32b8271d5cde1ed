"""Accuracy against work: relative errors against CPU seconds and unknowns, kshell beside its peers.

`python -m verification.work_precision` measures, draws and writes the tables.
"""
