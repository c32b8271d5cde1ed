"""Scenes as input files of other programs, so that an answer can be checked there."""
