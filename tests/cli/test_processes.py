"""Commands as processes: damage, other runs, full disks, closed streams, signals: a line each, and no litter."""

import os
import random
import signal
import time
from functools import partial
from pathlib import Path

import pytest

from tests.cli.processes import catches, files_below, group_members, shell, started, wait_until

pytestmark = pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="looks at processes as Linux shows them")

TABLE = "verify_pendulum_SYM.csv"
WROTE = f"wrote {TABLE}"
SMALL = "verify --map 50 --method SYM --scene pendulum --figure none --workers 1"
LONG = "verify --map 300 --method SYM --scene pendulum --figure none --workers 2"


def only_line(errors: bytes) -> str:
    """Return the one line of standard error; AssertionError if there are more or none."""
    (line,) = errors.decode().splitlines()
    return line


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return the table that the small job writes."""
    path = tmp_path_factory.mktemp("whole")
    assert shell(f"bezstab {SMALL}", path).returncode == 0
    return (path / TABLE).read_bytes()


def assert_resumes_to(whole: bytes, path: Path) -> None:
    """Assert that the small job goes on where it was stopped, to the same bytes, and leaves nothing else."""
    resumed = shell(f"bezstab {SMALL} --resume", path)
    assert (resumed.returncode, only_line(resumed.stderr)) == (0, WROTE)
    assert files_below(path) == [TABLE]
    assert (path / TABLE).read_bytes() == whole


@pytest.mark.slow
def test_a_killed_run_leaves_no_workers(tmp_path: Path) -> None:
    with started(LONG, tmp_path) as running:
        wait_until(lambda: chunks_in(tmp_path))
        assert len(group_members(running.pid)) >= 2
        running.kill()
        _, errors = running.communicate(timeout=60)  # ends when the last that could write there is gone
        assert errors == b""
        wait_until(lambda: not group_members(running.pid))


@pytest.mark.slow
def test_two_runs_at_once_in_the_same_place_both_write_the_whole(whole: bytes, tmp_path: Path) -> None:
    both = shell(f"bezstab {SMALL} & bezstab {SMALL} && wait $!", tmp_path)
    assert (both.returncode, both.stderr.decode().splitlines()) == (0, [WROTE, WROTE])
    assert files_below(tmp_path) == [TABLE]
    assert (tmp_path / TABLE).read_bytes() == whole


@pytest.mark.slow
def test_a_full_disk_takes_one_line_and_resume_goes_on(whole: bytes, tmp_path: Path) -> None:
    """A process whose files are limited must not keep compiled modules: Python leaves them cut short, for others."""
    full = shell(f"ulimit -f 1; PYTHONDONTWRITEBYTECODE=1 bezstab {SMALL}", tmp_path)  # files of 512 bytes
    assert full.returncode == 2
    assert only_line(full.stderr).startswith("bezstab: cannot write")
    assert not [name for name in files_below(tmp_path) if "/." in name or name.endswith(".csv")]
    assert_resumes_to(whole, tmp_path)


@pytest.mark.parametrize(
    ("to", "said"),
    [
        ("/dev/full", "No space left on device"),
        ("&-", "standard output is closed: there is nowhere to answer"),
    ],
)
def test_an_answer_that_cannot_be_printed_takes_one_line(to: str, said: str, tmp_path: Path) -> None:
    ended = shell(f"bezstab engines >{to}", tmp_path)
    assert (ended.returncode, only_line(ended.stderr)) == (2, f"bezstab: {said}")


@pytest.mark.slow
def test_a_closed_pipe_is_no_error_to_read_and_no_verdict(tmp_path: Path) -> None:
    """1 would say that fault was found, as it is here; 141 is what a shell says of SIGPIPE."""
    piped = shell("{ bezstab check --method SYM --alpha 3 --beta 3; echo $? >&2; } | true", tmp_path)
    assert piped.stderr == b"141\n"


def chunks_in(path: Path) -> set[Path]:
    """Return the parts of runs that are kept in a folder."""
    return set(path.glob("*.chunks/[0-9]*.joblib"))


@pytest.mark.parametrize(
    ("number", "said", "to_all"), [(signal.SIGINT, "interrupted", True), (signal.SIGTERM, "terminated", False)]
)
@pytest.mark.slow
def test_a_signal_ends_a_run_at_any_moment_and_resume_goes_on(
    number: signal.Signals, said: str, to_all: bool, whole: bytes, tmp_path: Path
) -> None:
    """To all: as a terminal sends Ctrl-C, to the workers too."""
    moments = random.Random(said)
    for most in (0.02, 0.5, 2.0):  # s after its start, at random
        kept = chunks_in(tmp_path)
        with started(f"{SMALL[:-1]}2 --resume", tmp_path) as running:
            wait_until(partial(catches, signal.SIGHUP, running.pid))  # until then Python alone starts
            time.sleep(moments.uniform(0, most))
            if running.poll() is None:
                os.killpg(running.pid, number) if to_all else running.send_signal(number)
            _, errors = running.communicate(timeout=60)
            wait_until(partial(lambda leader: not group_members(leader), running.pid))  # no worker is left
        if running.returncode:  # else it had just finished
            assert running.returncode == 128 + number
            *before, last = errors.decode().splitlines()
            assert last == f"bezstab: {said}"
            assert all("--resume goes on" in line or line.startswith("wrote ") for line in before)
            assert bool(chunks_in(tmp_path) - kept) <= bool(before)  # it says so if it has added to them
        assert not [name for name in files_below(tmp_path) if Path(name).name.startswith(".")]
    assert_resumes_to(whole, tmp_path)


@pytest.mark.slow
def test_an_interrupt_stops_what_computes_in_one_call(tmp_path: Path) -> None:
    with started("simulate --time 100000 --method RK4 --compiled yes", tmp_path) as running:
        time.sleep(5)  # until then it has begun to compute
        running.send_signal(signal.SIGINT)
        _, errors = running.communicate(timeout=60)
    assert (running.returncode, only_line(errors)) == (130, "bezstab: interrupted")
    assert files_below(tmp_path) == []


OLD = "env -u HOME MPLCONFIGDIR=/dev/null LC_ALL=C PYTHONCOERCECLOCALE=0 PYTHONUTF8=0"
"""There is no home, and files' names are ASCII."""


@pytest.mark.slow
def test_what_an_encoding_or_a_file_system_lacks_is_changed_and_json_is_not(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text('name = "é∞"\nA = [["0"]]\nb = ["1"]\n', encoding="utf-8")
    poles = "PYTHONIOENCODING=latin-1 bezstab poles --alpha 0.5 --beta 0.1 --method own.toml"
    assert shell(poles, tmp_path).stdout.startswith(b"?? = 0.5, ?? = 0.1: safe at rest.")
    assert b'"\\u00e9\\u221e"' in shell(f"{poles} --format json", tmp_path).stdout
    drawn = shell(f"{OLD} bezstab region --method own.toml --quality fast -o out", tmp_path)
    assert (drawn.returncode, only_line(drawn.stderr)[:17]) == (0, "wrote out/region_")
    assert len(files_below(tmp_path / "out")) == 1


@pytest.mark.slow
def test_a_terminal_shows_what_is_worked_on_and_a_pipe_does_not(tmp_path: Path) -> None:
    """A map's chunks; and a mechanism, whose equations may take many seconds before anything else is to be seen."""
    run = "simulate --scene pendulum --time 0.1 --figure none"
    check = "check --scene pendulum --method SYM --h 0.001 --alpha 0.5 --beta 0.1"
    for command in (SMALL, run, check):
        ours, theirs = os.openpty()
        with os.fdopen(theirs, "wb") as terminal:
            answered = shell(f"bezstab {command}", tmp_path, stderr=terminal)
        assert b"pendulum  [####################################]  100%" in os.read(ours, 65536)
        os.close(ours)
        assert b"100%" not in answered.stdout
