"""Chunks over processes and over a real Dask cluster: each done once, none lost, resumed to the same bytes.

In directories of finished ones every damage is seen, one run works at a time, nothing but what is known is removed.
"""

import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError, NumericalError
from bezstab.evidence.chunks import Arrays, ChunkStore, chunk_store, completed_chunks, worker_pool
from tests.evidence.samples import of_campaign


@dataclass(frozen=True)
class Job:
    """What a worker is to do: square a number, after having killed itself once for each file it still finds missing."""

    number: int
    deaths: tuple[Path, ...] = ()


def square(job: Job) -> Arrays:
    for death in job.deaths:
        if not death.exists():
            death.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    if job.number < 0:
        raise InputError(f"at {job.number}")
    return {"square": np.array(job.number**2), "by": np.array(os.getpid())}


def squares(found: dict[int, Arrays]) -> list[int]:
    return [int(found[number]["square"]) for number in sorted(found)]


def arrived(jobs: list[Job], workers: Executor, folder: Path, damaged: tuple[str, ...] = ()) -> dict[int, Arrays]:
    """Return what all chunks of a job in this folder give, those that are there already included."""
    reported: list[str] = []
    with chunk_store(folder / "job", "squares", resume=True) as store:
        found = list(completed_chunks(square, jobs, workers, store, lambda file: reported.append(file.name)))
        assert all(store.load(number) for number in range(len(jobs)))
    assert sorted(number for number, _ in found) == list(range(len(jobs)))  # each done once
    assert tuple(reported) == damaged
    return dict(found)


def test_a_resumed_job_does_only_what_is_missing_or_damaged(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        store.save(1, {"square": np.array(-1)})
        store.save(3, {"square": np.array(-9)})  # one more than there are jobs
        store.file(2).write_bytes(b"damaged")
    with worker_pool(1) as workers:
        found = arrived([Job(number) for number in range(3)], workers, tmp_path, damaged=("2.npz",))
    assert squares(found) == [0, -1, 4]  # the second was not done again


@pytest.mark.slow
def test_a_lost_worker_is_one_line_and_what_is_done_is_kept(tmp_path: Path) -> None:
    jobs = [Job(0), Job(1, (tmp_path / "death",))]
    with (
        pytest.raises(NumericalError, match=r"a worker was lost, .* --resume goes on"),
        worker_pool(1) as workers,
    ):
        arrived(jobs, workers, tmp_path)
    with worker_pool(1) as workers:
        found = arrived(jobs, workers, tmp_path)
    assert squares(found) == [0, 1]
    by_the_lost_one, by_another = (int(found[number]["by"]) for number in range(2))
    assert len({os.getpid(), by_the_lost_one, by_another}) == 3


def test_what_a_worker_raises_is_raised_here(tmp_path: Path) -> None:
    with worker_pool(1) as workers, pytest.raises(InputError, match="at -1"):
        arrived([Job(-1)], workers, tmp_path)


def test_busy_workers_are_ended_at_once_where_nobody_waits_for_them() -> None:
    with worker_pool(1) as workers:
        busy = workers.submit(time.sleep, 1000)
    with pytest.raises(BrokenProcessPool):
        busy.result(timeout=60)


def test_a_scheduler_that_does_not_answer_is_one_line() -> None:
    with pytest.raises(InputError, match="--scheduler nonsense"), worker_pool(scheduler="nonsense://x"):
        pass


@pytest.fixture
def cluster() -> Iterator[str]:
    """Run a real scheduler and two workers, each a process of its own, on loopback."""
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent.parent.parent)}  # where workers find this file
    port = 20000 + os.getpid() % 20000
    address = f"tcp://127.0.0.1:{port}"
    commands = f"scheduler --host 127.0.0.1 --port {port}", f"worker {address} --nworkers 2 --nthreads 1"
    running = [
        subprocess.Popen(
            [sys.executable, "-m", *f"distributed.cli.dask_{command} --no-dashboard".split()],
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for command in commands
    ]
    try:
        yield address
    finally:
        for process in reversed(running):
            process.terminate()
            process.wait(timeout=30)


@pytest.mark.slow
def test_a_cluster_does_the_same_work(cluster: str, tmp_path: Path) -> None:
    death = tmp_path / "died"
    jobs = [Job(number, (death,) * (number == 2)) for number in range(6)]
    with worker_pool(scheduler=cluster) as workers:
        found = arrived(jobs, workers, tmp_path)
    command = [sys.executable, "-m", "bezstab", "verify", "--map", "4", "--method", "SYM", "--scene", "pendulum"]
    maps = {}
    for name, more in (("here", ["--workers", "1"]), ("there", ["--scheduler", cluster])):
        subprocess.run([*command, "-o", name, *more], cwd=tmp_path, check=True, capture_output=True, timeout=120)
        maps[name] = (tmp_path / name / "verify_pendulum_SYM.csv").read_bytes()
    assert maps["here"] == maps["there"]
    assert squares(found) == [number**2 for number in range(6)]
    assert death.exists()  # one worker was lost, and replaced, on the way
    assert os.getpid() not in {int(arrays["by"]) for arrays in found.values()}


SQUARES = {"square": np.array([1, 4, 9]), "name": np.array(["a", "b"])}


@pytest.fixture
def store(tmp_path: Path) -> Iterator[ChunkStore]:
    with chunk_store(tmp_path / "job", "squares", resume=False) as opened:
        opened.save(0, SQUARES)
        yield opened


def test_a_flipped_bit_is_seen_or_does_no_harm_and_every_truncation_is_seen(store: ChunkStore) -> None:
    content, seen = store.file(0).read_bytes(), []
    for bit in range(0, 8 * len(content), of_campaign(1, 13)):
        damaged = bytearray(content)
        damaged[bit // 8] ^= 1 << bit % 8
        store.file(0).write_bytes(damaged)
        loaded = store.load(0)
        seen.append(loaded is None)
        if loaded is not None:
            np.testing.assert_equal(loaded, SQUARES)
    assert np.mean(seen) > 0.5  # most bits matter
    for length in range(0, len(content), 7):
        store.file(0).write_bytes(content[:length])
        assert store.load(0) is None


def test_a_chunk_of_another_number_is_not_taken_nor_what_is_none(store: ChunkStore) -> None:
    shutil.copy(store.file(0), store.file(1))
    assert store.load(1) is None
    (store.path / "7.npz").mkdir()
    assert store.load(7) is None


def test_chunks_of_another_job_or_of_none_are_not_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / "job"
    with chunk_store(path, "squares", resume=False) as store:
        store.save(0, SQUARES)
    for job in (b"cubes", b"\xff\xfe"):
        (path / "job.txt").write_bytes(job)
        with pytest.raises(InputError, match=r"--resume: .* other options"), chunk_store(path, "squares", resume=True):
            pass
    (path / "job.txt").unlink()
    with chunk_store(path, "squares", resume=True) as store:
        assert store.load(0) is None
        store.save(0, SQUARES)
    with chunk_store(path, "squares", resume=False) as store:
        assert store.load(0) is None


def test_two_runs_do_not_work_in_the_same_place(store: ChunkStore) -> None:
    for resume in (False, True):
        with pytest.raises(InputError, match=r"in use by another run \(process \d+\)"):
            chunk_store(store.path, "squares", resume).__enter__()
    assert store.load(0) is not None  # nothing of the first was touched


def test_what_a_killed_run_had_half_written_goes_and_what_is_not_ours_stays(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        (store.path / ".3.npz.0a1b").touch()
        store.discard()
    assert not (tmp_path / "job").exists()
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        (store.path / "mine").mkdir()
        store.discard()
    assert [path.name for path in (tmp_path / "job").iterdir()] == ["mine"]


def count_up(path: Path, times: int) -> None:
    """Add one to a number in a file, so often, reading and writing it only inside the store's lock."""
    done = 0
    while done < times:
        try:
            with chunk_store(path / "job", "count", resume=False) as store:
                number = int((path / "count").read_text())
                (path / "count").write_text(f"{number + 1}")
                store.save(0, SQUARES)
                store.discard()
                done += 1
        except InputError:
            continue  # in use


@pytest.mark.slow
def test_many_runs_that_come_and_go_never_meet(tmp_path: Path) -> None:
    (tmp_path / "count").write_text("0")
    spawn = multiprocessing.get_context("spawn")
    processes = [spawn.Process(target=count_up, args=(tmp_path, 10)) for _ in range(3)]
    for process in processes:
        process.start()
    for process in processes:
        process.join(timeout=100)
        assert process.exitcode == 0
    assert (tmp_path / "count").read_text() == "30"
