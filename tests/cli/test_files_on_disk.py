"""What happens to files while a run works on them (damage, other runs, full disks, signals): a line, no litter."""

import os
import pickle
import random
import resource
import shutil
import signal
import subprocess
import time
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from tests.cli.processes import catches, files_below, finished, group_members, started, wait_until

pytestmark = pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="looks at processes as Linux shows them")

SLOW = pytest.mark.slow
NAME = "verify_pendulum_SYM"
SMALL = ("verify", "--map", "6", "--method", "SYM", "--scene", "pendulum", "--figure", "none", "--workers", "1")
LONG = ("verify", "--map", "300", "--method", "SYM", "--scene", "pendulum", "--figure", "none", "--workers", "2")
SWEEP = ("tradeoff", "--method", "SYM", "--h", "0.01", "--h", "0.02", "--time", "0.1", "--figure", "none")


def only_line(errors: bytes) -> str:
    """Return the one line of standard error; AssertionError if there are more or none."""
    (line,) = errors.decode().splitlines()
    return line


def wait_for_chunk(path: Path, running: "subprocess.Popen[bytes]") -> None:
    wait_until(lambda: list(path.glob("*.chunks/[0-9]*.npz")), running)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return the table that the small job writes."""
    path = tmp_path_factory.mktemp("whole")
    assert finished(*SMALL, cwd=path).returncode == 0
    return (path / f"{NAME}.csv").read_bytes()


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a directory in which the small job was killed when its chunks were finished, but not its table."""
    path = tmp_path_factory.mktemp("interrupted")
    (path / f"{NAME}.csv").mkdir()  # so that the table cannot be written
    assert finished(*SMALL, cwd=path).returncode == 2
    (path / f"{NAME}.csv").rmdir()
    assert list(path.glob("*.chunks/[0-9]*.npz"))
    return path


class Hostile:
    """An object that creates a file if it is unpickled."""

    def __reduce__(self) -> tuple[Callable[..., object], tuple[str, str]]:
        return open, ("unpickled", "w")


def truncate(chunk: Path) -> None:
    chunk.write_bytes(chunk.read_bytes()[:-30])


def flip_a_bit(chunk: Path) -> None:
    content = bytearray(chunk.read_bytes())
    content[len(content) // 3] ^= 4
    chunk.write_bytes(content)


def empty(chunk: Path) -> None:
    chunk.write_bytes(b"")


def put_text(chunk: Path) -> None:
    chunk.write_text("not an archive")


def put_one_array(chunk: Path) -> None:
    with chunk.open("wb") as file:
        np.save(file, np.arange(3))


def put_other_arrays(chunk: Path) -> None:
    with chunk.open("wb") as file:
        np.savez(file, other=np.arange(3))


def put_hostile_archive(chunk: Path) -> None:
    with chunk.open("wb") as file:
        np.savez(file, diverges=np.array([Hostile()], dtype=object))


def put_hostile_archive_of_a_pickle(chunk: Path) -> None:
    with zipfile.ZipFile(chunk, "w") as archive:
        archive.writestr("diverges.npy", pickle.dumps(Hostile()))


def put_pickle(chunk: Path) -> None:
    chunk.write_bytes(pickle.dumps(Hostile()))


@pytest.mark.parametrize(
    "damage",
    [
        pytest.param(put_hostile_archive, marks=SLOW),
        pytest.param(truncate, marks=SLOW),
        pytest.param(flip_a_bit, marks=SLOW),
        pytest.param(empty, marks=SLOW),
        pytest.param(put_text, marks=SLOW),
        pytest.param(put_one_array, marks=SLOW),
        pytest.param(put_other_arrays, marks=SLOW),
        pytest.param(put_hostile_archive_of_a_pickle, marks=SLOW),
        pytest.param(put_pickle, marks=SLOW),
    ],
)
def test_a_damaged_chunk_is_computed_again_to_the_same_bytes(
    damage: Callable[[Path], None], interrupted: Path, whole: bytes, tmp_path: Path
) -> None:
    shutil.copytree(interrupted, tmp_path, dirs_exist_ok=True)
    chunk = tmp_path / f"{NAME}.chunks" / "0.npz"
    damage(chunk)
    resumed = finished(*SMALL, "--resume", cwd=tmp_path)
    assert resumed.returncode == 0
    said, wrote = resumed.stderr.decode().splitlines()
    assert said == f"bezstab: {NAME}.chunks/0.npz is damaged: computed again"
    assert wrote == f"wrote {NAME}.csv"
    assert files_below(tmp_path) == [f"{NAME}.csv"]  # nothing was unpickled, and the chunks are gone
    assert (tmp_path / f"{NAME}.csv").read_bytes() == whole


@SLOW
def test_a_second_run_in_the_same_place_names_the_first_and_the_next_starts_when_that_was_killed(
    tmp_path: Path,
) -> None:
    with started(*LONG, cwd=tmp_path) as first:
        wait_for_chunk(tmp_path, first)
        for more in ([], ["--resume"]):
            second = finished(*LONG, *more, cwd=tmp_path)
            assert second.returncode == 2
            assert f"process {first.pid}" in only_line(second.stderr)
        assert first.poll() is None
        first.kill()
    with started(*LONG, "--resume", cwd=tmp_path) as third:
        known = len(list(tmp_path.glob("*.chunks/[0-9]*.npz")))
        wait_until(lambda: len(list(tmp_path.glob("*.chunks/[0-9]*.npz"))) > known, third)


@SLOW
def test_the_workers_of_a_killed_run_are_gone_and_nothing_is_said(tmp_path: Path) -> None:
    with started(*LONG, cwd=tmp_path) as running:
        wait_for_chunk(tmp_path, running)
        assert len(group_members(running.pid)) >= 2
        running.kill()
        _, errors = running.communicate(timeout=60)  # ends when the last that could write there is gone
        assert errors == b""
        deadline = time.monotonic() + 5
        wait_until(lambda: not group_members(running.pid))
        assert time.monotonic() < deadline


# a process whose files are limited must not keep compiled modules: Python leaves them cut short, for all others to read
COMPILES_FOR_ITSELF = {"PYTHONDONTWRITEBYTECODE": "1"}


def finished_on_a_full_disk(*arguments: str, size: int, cwd: Path) -> subprocess.CompletedProcess[bytes]:
    """Return what a command printed whose files may have so many bytes each: to it, the disk is full there."""
    return finished(
        *arguments,
        cwd=cwd,
        environment=COMPILES_FOR_ITSELF,
        prepare=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
    )


@SLOW
@pytest.mark.parametrize("size", [0, 100, 700])
def test_a_full_disk_takes_one_line_and_resume_goes_on(size: int, whole: bytes, tmp_path: Path) -> None:
    full = finished_on_a_full_disk(*SMALL, size=size, cwd=tmp_path)
    assert full.returncode == 2
    assert only_line(full.stderr).startswith("bezstab: cannot write")
    assert not [name for name in files_below(tmp_path) if "/." in name or name.endswith(".csv")]
    assert finished(*SMALL, "--resume", cwd=tmp_path).returncode == 0
    assert files_below(tmp_path) == [f"{NAME}.csv"]
    assert (tmp_path / f"{NAME}.csv").read_bytes() == whole


@pytest.mark.parametrize(
    "command",
    [
        "region --method B2 --grid 20 --table npz",
        pytest.param("simulate --time 0.1 --table csv", marks=SLOW),
        pytest.param("region --method B2 --grid 20 --figure svg", marks=SLOW),
        pytest.param("region --method B2 --grid 20 --figure pdf --table none", marks=SLOW),
        pytest.param("simulate --time 0.1 --figure none --table npz", marks=SLOW),
        pytest.param("family bezier --from 2 --to 3", marks=SLOW),
    ],
)
@pytest.mark.slow
def test_a_full_disk_leaves_no_part_of_a_result(command: str, tmp_path: Path) -> None:
    full = finished_on_a_full_disk(*command.split(), size=1000, cwd=tmp_path)
    assert full.returncode == 2
    assert only_line(full.stderr).startswith("bezstab: cannot write")
    assert files_below(tmp_path) == []


@pytest.mark.parametrize(
    ("below", "becomes_a_file"),
    [
        pytest.param(f"out/{NAME}.chunks", True, marks=SLOW),
        pytest.param("out", False, marks=SLOW),
    ],
)
def test_a_directory_that_goes_away_midway_takes_one_line(below: str, becomes_a_file: bool, tmp_path: Path) -> None:
    with started(*LONG, "-o", "out", cwd=tmp_path) as running:
        wait_for_chunk(tmp_path / "out", running)
        moved = tmp_path / "moved"
        (tmp_path / below).rename(moved)  # at once, so that no chunk is written while it is taken away
        if becomes_a_file:
            (tmp_path / below).touch()
        _, errors = running.communicate(timeout=60)
        assert running.returncode == 2
        assert only_line(errors).startswith("bezstab: cannot write")
        wait_until(lambda: not group_members(running.pid))
    assert not [name for name in files_below(tmp_path) if "/." in name]
    if becomes_a_file:
        (tmp_path / below).unlink()
    moved.rename(tmp_path / below)
    with started(*LONG, "-o", "out", "--resume", cwd=tmp_path) as resumed:
        wait_until(lambda: catches(signal.SIGHUP, resumed.pid), resumed)


STREAMS = [
    *("--version", "engines"),
    *(
        pytest.param(text, marks=SLOW)
        for text in ("--help", "poles --alpha 1 --beta 1", "poles --alpha 1 --beta 1 --format json")
    ),
]


@pytest.mark.parametrize("command", STREAMS)
def test_an_answer_for_which_there_is_no_space_takes_one_line(command: str, tmp_path: Path) -> None:
    with Path("/dev/full").open("wb") as full:
        run = finished(*command.split(), cwd=tmp_path, stdout=full)
    assert run.returncode == 2
    assert only_line(run.stderr) == "bezstab: No space left on device"


@pytest.mark.parametrize("command", STREAMS)
def test_a_closed_standard_output_takes_one_line(command: str, tmp_path: Path) -> None:
    run = finished(*command.split(), cwd=tmp_path, prepare=lambda: os.close(1))
    assert run.returncode == 2
    assert only_line(run.stderr) == "bezstab: standard output is closed: there is nowhere to answer"


def close_standard_streams() -> None:
    for descriptor in (0, 1, 2):
        os.close(descriptor)


def test_without_any_stream_nothing_is_said_and_nothing_written(tmp_path: Path) -> None:
    assert finished("region", "--method", "B2", cwd=tmp_path, prepare=close_standard_streams).returncode == 2
    assert files_below(tmp_path) == []


@SLOW
@pytest.mark.parametrize("how", ["closed", "full"])
def test_an_answer_needs_no_standard_error(how: str, whole: bytes, tmp_path: Path) -> None:
    def close_errors() -> None:
        os.close(2)

    with Path("/dev/full").open("wb") as full:
        if how == "closed":
            run = finished(*SMALL, cwd=tmp_path, prepare=close_errors)
        else:
            run = finished(*SMALL, cwd=tmp_path, stderr=full)
    assert run.returncode == 0
    assert run.stdout
    assert files_below(tmp_path) == [f"{NAME}.csv"]
    assert (tmp_path / f"{NAME}.csv").read_bytes() == whole


MOMENTS = (0.02, 0.5, 2.0, 2.0)
"""s after the start of a run until which it is told to end, at random; then it is started again."""

SIGNALS = {signal.SIGINT: ("interrupted", 130), signal.SIGTERM: ("terminated", 143), signal.SIGHUP: ("hung up", 129)}


def check_stopped(number: signal.Signals, running: "subprocess.Popen[bytes]", path: Path) -> None:
    """Assert that a run which was told to end has: by its line and status, or because it was just finished."""
    _, errors = running.communicate(timeout=60)
    wait_until(lambda: not group_members(running.pid))  # no worker is left
    word, status = SIGNALS[number]
    lines = errors.decode().splitlines()
    if running.returncode != 0:
        assert running.returncode == status
        assert lines[-1] == f"bezstab: {word}"
        assert [line for line in lines[:-1] if "--resume goes on" not in line and not line.startswith("wrote ")] == []
    assert not [name for name in files_below(path) if Path(name).name.startswith(".")]


@pytest.mark.parametrize(
    ("name", "to_all", "latest"),
    [
        ("SIGINT", True, (1.5,)),  # as a terminal sends Ctrl-C, to the workers too
        pytest.param("SIGINT", True, MOMENTS, marks=SLOW),
        pytest.param("SIGTERM", False, MOMENTS, marks=SLOW),
        pytest.param("SIGHUP", True, MOMENTS, marks=SLOW),
        pytest.param("SIGINT", False, MOMENTS, marks=SLOW),
        pytest.param("SIGTERM", True, MOMENTS, marks=SLOW),
        pytest.param("SIGHUP", False, MOMENTS, marks=SLOW),
    ],
)
@pytest.mark.slow
def test_a_signal_ends_a_run_at_any_moment_and_resume_goes_on(
    name: str, to_all: bool, latest: Sequence[float], whole: bytes, tmp_path: Path
) -> None:
    number = signal.Signals[name]
    moments = random.Random(f"{number} {to_all}")
    command = (*SMALL, "--workers", "2")
    for most in latest:
        with started(*command, "--resume", cwd=tmp_path) as running:
            wait_until(
                lambda: catches(signal.SIGHUP, running.pid), running
            )  # until then it is Python alone that starts
            time.sleep(moments.uniform(0, most))
            if running.poll() is None:
                os.killpg(running.pid, number) if to_all else running.send_signal(number)
            check_stopped(number, running, tmp_path)
    assert finished(*command, "--resume", cwd=tmp_path).returncode == 0
    assert files_below(tmp_path) == [f"{NAME}.csv"]
    assert (tmp_path / f"{NAME}.csv").read_bytes() == whole


@pytest.mark.parametrize(
    "command",
    [
        "region --method B2",
        pytest.param("--help", marks=SLOW),
        pytest.param("poles --alpha 1 --beta 1", marks=SLOW),
        pytest.param("simulate --time 0.5", marks=SLOW),
    ],
)
def test_a_signal_ends_every_command_at_any_moment(command: str, tmp_path: Path) -> None:
    moments = random.Random(command)
    for number in SIGNALS:
        with started(*command.split(), cwd=tmp_path) as running:
            wait_until(lambda: catches(signal.SIGHUP, running.pid), running)
            time.sleep(moments.uniform(0, 1.0))
            if running.poll() is None:
                running.send_signal(number)
            check_stopped(number, running, tmp_path)


@pytest.mark.slow
def test_a_signal_that_was_ignored_stays_so(tmp_path: Path) -> None:
    def ignore_hangup() -> None:
        signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does

    with started("poles", "--alpha", "1", "--beta", "1", cwd=tmp_path, prepare=ignore_hangup) as running:
        wait_until(lambda: catches(signal.SIGTERM, running.pid), running)
        running.send_signal(signal.SIGHUP)
        assert running.wait(timeout=60) == 0


@pytest.mark.slow
def test_a_damaged_chunk_of_a_sweep_is_measured_again(tmp_path: Path) -> None:
    (table := tmp_path / "tradeoff_slider_crank_light.csv").mkdir()
    assert finished(*SWEEP, cwd=tmp_path).returncode == 2
    table.rmdir()
    truncate(tmp_path / "tradeoff_slider_crank_light.chunks" / "0.npz")
    resumed = finished(*SWEEP, "--resume", cwd=tmp_path)
    assert resumed.returncode == 0
    assert b"0.npz is damaged: computed again\n" in resumed.stderr
    assert files_below(tmp_path) == [table.name]
