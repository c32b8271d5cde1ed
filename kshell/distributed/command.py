"""A command on several processes: one message, one exit code, and none left waiting.

An error of a team is raised by all of its processes (`kshell.distributed.team`). Whatever else ends one of them
alone, a fault or a full disk, finds the others in the middle of something: so each tells the others how it ended. Where
all end within a moment the first one with an error speaks and all return its exit code; where some do not, they wait
for one that is gone, and it ends them.
"""

from __future__ import annotations

import io
import os
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

from kshell.distributed.launch import launched
from kshell.distributed.team import require_installed
from kshell.errors import InputError

# commands that several processes share
SHARED = ("solve", "trace", "modes")
GRACE = 1.5  # seconds in which the others may end by themselves
PAUSE = 0.01
ENDED = 7  # tag of the messages in which they say how they ended


def run_together(run: Callable[[Sequence[str]], int], arguments: Sequence[str]) -> int:
    """Run a command line on all processes; the exit code, the same on all.

    Parameters
    ----------
    run : function
        Runs a command line on one process and returns its exit code, with messages on stderr.
    """
    start = launched()
    assert start is not None
    speaks = start.rank == 0
    try:
        require_installed()
        _require_shared(arguments)
    except InputError as error:
        if speaks:
            print(f"error: {error}", file=sys.stderr)
        return 2
    os.environ.setdefault("MPIR_CVAR_SUPPRESS_ABORT_MESSAGE", "1")  # of MPICH: kshell says why
    from mpi4py import MPI

    channel = MPI.COMM_WORLD.Dup()
    said, heard = sys.stderr, io.StringIO()
    if not speaks:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - until the process ends
        sys.stderr = heard
    code = _code_of(run, arguments)
    sys.stdout.flush()
    sys.stderr = said
    found, complete = _meet(channel, code, GRACE if code else None)
    failed = [rank for rank in sorted(found) if found[rank]]
    if not failed:
        return 0
    first = failed[0]
    if first == start.rank and not speaks:
        said.write(_last_message(heard.getvalue(), "--debug" in arguments))
    said.flush()
    if complete:
        return found[first]
    if first != start.rank:
        time.sleep(2.0 * GRACE)  # that one ends all; unless it cannot
    channel.Abort(found[first])
    return found[first]


def _code_of(run: Callable[[Sequence[str]], int], arguments: Sequence[str]) -> int:
    try:
        return run(arguments)
    except SystemExit as error:
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException:
        sys.excepthook(*sys.exc_info())
        return 1


def _meet(channel: object, code: int, patience: float | None) -> tuple[dict[int, int], bool]:
    """Exit codes of the processes that have ended, by rank, and whether these are all.

    Parameters
    ----------
    patience : float, optional
        Seconds to wait for others; without end if absent: who ended well waits for all.
    """
    from mpi4py import MPI

    comm: Any = channel
    sent = [comm.isend(code, other, ENDED) for other in range(comm.size) if other != comm.rank]
    found = {comm.rank: code}
    begin = time.monotonic()
    while len(found) < comm.size:
        status = MPI.Status()
        if comm.iprobe(MPI.ANY_SOURCE, ENDED, status):
            found[status.Get_source()] = comm.recv(source=status.Get_source(), tag=ENDED)
            if patience is None and any(found.values()):
                patience = time.monotonic() - begin + 4.0 * GRACE  # who failed ends all before that
            continue
        if patience is not None and time.monotonic() - begin > patience:
            return found, False
        time.sleep(PAUSE)
    MPI.Request.waitall(sent)
    return found, True


def _last_message(text: str, whole: bool) -> str:
    """What a silent process would have said: its error, or with --debug all."""
    begin = text.rfind("error: ")
    return text if whole or begin < 0 else text[begin:]


def _require_shared(arguments: Sequence[str]) -> None:
    """Raise InputError for a command that is one process's."""
    words = [word for word in arguments if not word.startswith("-")]
    if words and words[0] not in SHARED and not {"--help", "--version"} & set(arguments):
        raise InputError(
            f"kshell {words[0]} is not for several processes: run it without mpiexec; those for several are "
            f"{', '.join(SHARED)}"
        )
