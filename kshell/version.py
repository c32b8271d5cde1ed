"""The version of kshell."""

__version__ = "0.1.0"
