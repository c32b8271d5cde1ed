"""Runs the verification cases on this machine and reports: behind `kshell verify`."""

from verification.suite.command import verify

__all__ = ["verify"]
