"""What can go wrong, as the user meets it: bad input, no answer, or a warning."""

from __future__ import annotations

from typing import Any


class KshellError(Exception):
    """Base of all errors kshell raises on purpose. The message says what, where, and how to mend it."""


class InputError(KshellError):
    """The input is wrong or incomplete; nothing was solved and nothing was written."""


class SolveError(KshellError):
    """No answer was reached.

    Parameters
    ----------
    message : str
        What failed, where, and how to mend it.
    state : object, optional
        The last good state: for an iterative solve the best iterate and the history.
    """

    def __init__(self, message: str, state: Any = None) -> None:
        super().__init__(message)
        self.state = state


class Interrupted(KeyboardInterrupt):
    """The user stopped a path; `state` is the result of the last converged step."""

    def __init__(self, message: str, state: Any = None) -> None:
        super().__init__(message)
        self.state = state


class KshellWarning(UserWarning):
    """The answer stands, but something about it deserves attention."""


LONGEST = 200  # characters of a value in a message


def clipped(text: object) -> str:
    """A text in a message, cut where it is long."""
    text = str(text)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}... ({len(text)} characters)"
