import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from tests.cli.running import interruptible


@pytest.mark.slow
def test_an_interrupted_map_says_how_to_go_on(tmp_path: Path) -> None:
    command = interruptible("verify", "--map", "300", "--workers", "1")
    running = subprocess.Popen(command, stderr=subprocess.PIPE, cwd=tmp_path, start_new_session=True)
    while not list(tmp_path.glob("*.chunks/[0-9]*.npz")):
        assert running.poll() is None
        time.sleep(0.1)
    os.killpg(running.pid, signal.SIGINT)  # as a terminal does, to the workers too
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 130
    advice, interrupted = filter(None, errors.decode().splitlines())  # click breaks the line of ^C
    assert "--resume" in advice
    assert interrupted == "bezstab: interrupted"
