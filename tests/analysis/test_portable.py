"""A plate and a shell are solved where there is nothing of POSIX, as on Windows."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

# what Windows has not; psutil is imported first, because on Linux it needs them itself
WITHOUT = """
import os, signal, sys
import psutil
for name in ("resource", "fcntl", "pwd", "grp", "termios"):
    sys.modules[name] = None
for name in ("fork", "forkpty", "getuid", "sysconf", "killpg"):
    if hasattr(os, name):
        delattr(os, name)
for name in ("SIGKILL", "SIGHUP", "SIGUSR1", "alarm", "setitimer", "pause"):
    if hasattr(signal, name):
        delattr(signal, name)
from kshell.cli.commands import run
plate, shell, out = sys.argv[1:]
code = run(["solve", plate, "-o", out + "/plate"]) or run(["solve", shell, "-o", out + "/shell"])
assert all(sys.modules[name] is None for name in ("resource", "fcntl"))
assert not hasattr(os, "fork") and not hasattr(signal, "SIGKILL")
sys.exit(code)
"""


def test_plate_and_shell_without_posix(tmp_path):
    scenes = [str(ROOT / "meshes" / name) for name in ("plate.toml", "scordelis_lo.toml")]
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT, *scenes, str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stderr
    for kind in ("plate", "shell"):
        found = json.loads((tmp_path / kind / "result.json").read_text(encoding="utf-8"))
        assert found["model"]["kind"] == kind
        assert found["balance"] < 1e-8
        assert found["solver"]["peak_memory_mb"] > 10
