"""A result as one HTML file that needs nothing else: what was asked, what was found, and a view of it in 3D."""

from kshell.report.page import write_report

__all__ = ["write_report"]
