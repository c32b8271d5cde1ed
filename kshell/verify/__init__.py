"""Runs the verification cases on this machine and reports: behind `kshell verify`."""

from kshell.verify.command import verify

__all__ = ["verify"]
