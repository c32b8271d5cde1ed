"""What a long solve says on stderr while it runs, and into a file with --log."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from kshell.errors import InputError

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

PATIENCE = 1.0  # seconds before progress is shown to someone who watches
# seconds before the first plain line into a pipe or file, and between two of them
PLAIN_EVERY = 10.0
LEVEL = "level "  # words that a line of their own is kept for: each mesh of a refinement


class Progress:
    """Names what is done, with the time it took so far: on a terminal in one line that moves, else in plain lines.

    Parameters
    ----------
    log : Path, optional
        Every step is written there with its time, at once.
    """

    def __init__(self, log: Path | None = None) -> None:
        self.stage = "read"
        self._log_path, self._log = log, None if log is None else _opened(log)
        self._bar: Bar | None = None
        self._lock = threading.Lock()
        self._timer: threading.Timer | None = None
        self._begin = self._last = time.monotonic()

    def __call__(self, stage: str) -> None:
        with self._lock:
            self.stage = stage
            self._note(stage)
            if self._timer is None and sys.stderr.isatty():
                self._timer = threading.Timer(PATIENCE, self._show)
                self._timer.daemon = True
                self._timer.start()
            if stage.startswith(LEVEL):
                self._keep(f"kshell: {stage}")
            elif self._bar is not None:
                self._bar.update(self._bar.task_ids[0], description=stage)
            elif not sys.stderr.isatty():
                self._plain()

    def _keep(self, line: str) -> None:
        if self._bar is None:
            print(line, file=sys.stderr, flush=True)
        else:
            self._bar.console.print(line, markup=False, highlight=False)

    def _note(self, words: str) -> None:
        if self._log is not None:
            print(f"{datetime.now().isoformat(timespec='milliseconds')} {words}", file=self._log, flush=True)

    def _plain(self) -> None:
        now = time.monotonic()
        if now - self._last >= PLAIN_EVERY:
            self._last = now
            print(f"kshell: {now - self._begin:.0f} s, {self.stage}", file=sys.stderr, flush=True)

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import Progress as Bar
        from rich.progress import SpinnerColumn, TextColumn, TimeElapsedColumn

        with self._lock:
            columns = (SpinnerColumn(), TimeElapsedColumn(), TextColumn("{task.description}", markup=False))
            self._bar = Bar(*columns, console=Console(stderr=True), transient=True)
            self._bar.add_task(self.stage, total=None)
            self._bar.start()

    @contextmanager
    def shown(self) -> Iterator[Progress]:
        """Show while the block runs, from the first call on: until then this begins no thread."""
        try:
            yield self
        except BaseException as error:
            self._note(f"ended by {type(error).__name__}: {error}")
            raise
        else:
            self._note("done")
        finally:
            if self._timer is not None:
                self._timer.cancel()
            with self._lock:
                if self._bar is not None:
                    self._bar.stop()
                if self._log is not None:
                    self._log.close()


def _opened(path: Path) -> TextIO:
    try:
        return path.open("a", encoding="utf-8")
    except OSError as error:
        raise InputError(f"--log {path}: cannot be written ({error.strerror or error})") from None
