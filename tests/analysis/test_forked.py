"""Processes forked for many calls: answers in order, errors, processes that die, and when there are none."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from kshell.analysis.forked import Forked, can_fork

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are forked on Linux")


def lost(why: str) -> str:
    return why


def test_answers_come_in_the_order_of_the_numbers() -> None:
    def call(number: int) -> tuple[int, int]:
        time.sleep(0.05 * (number % 3 == 0))  # the first of each round comes last
        return number, os.getpid()

    with Forked(call, 2) as processes:
        found = list(processes.answers(7, lost))
    assert [number for number, _ in found] == list(range(7))
    assert len({process for _, process in found}) == 2
    assert os.getpid() not in {process for _, process in found}


def test_a_process_that_dies_costs_its_own_answer_alone() -> None:
    def call(number: int) -> str:
        if number in (1, 4):
            os.kill(os.getpid(), signal.SIGKILL)
        if number == 5:
            os._exit(3)
        return "answer"

    with Forked(call, 2) as processes:
        found = list(processes.answers(8, lost))
    assert [k for k, words in enumerate(found) if words != "answer"] == [1, 4, 5]
    assert "SIGKILL" in found[1]
    assert "memory" in found[1]
    assert "code 3" in found[5]


def test_errors_are_raised_here_and_end_the_processes() -> None:
    def call(number: int) -> int:
        if number == 1:
            raise ZeroDivisionError("of one point")
        return os.getpid()

    with Forked(call, 2) as processes, pytest.raises(ZeroDivisionError, match="of one point"):
        list(processes.answers(3, lost))
    with Forked(call, 1) as processes:
        process = next(iter(processes.answers(1, lost)))
        os.kill(process, 0)  # it waits for more
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_no_fork_beside_other_threads() -> None:
    done = threading.Event()
    thread = threading.Thread(target=done.wait)
    thread.start()
    try:
        assert not can_fork()
    finally:
        done.set()
        thread.join()


# whoever started the tests may have had interrupts ignored, as shells do for jobs in the background
ALONE = """
import os, signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)
import numpy as np
from kshell.analysis.forked import Forked, can_fork
from kshell.analysis.sweep import _warm_up
_warm_up()  # no thread is left of it
a = np.ones((300, 300))
a @ a
assert can_fork()
def call(number):
    a @ a
    open(sys.argv[1] + f"/{os.getpid()}", "w").close()
    if number == 1:
        os.kill(os.getppid(), signal.SIGINT)
        time.sleep(3600.0)
    return number
try:
    with Forked(call, 2) as processes:
        print(list(processes.answers(4, str)))
except KeyboardInterrupt:
    print("interrupted")
"""


def test_the_interrupt_key_ends_all_though_blas_has_threads(tmp_path) -> None:
    several = {**os.environ, "OPENBLAS_NUM_THREADS": "2", "OMP_NUM_THREADS": "2"}
    done = subprocess.run(
        [sys.executable, "-c", ALONE, str(tmp_path)], env=several, capture_output=True, text=True, timeout=300
    )
    assert done.stdout.strip() == "interrupted", done.stderr
    for file in tmp_path.iterdir():
        with pytest.raises(ProcessLookupError):
            os.kill(int(file.name), 0)
