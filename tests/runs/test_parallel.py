"""Chunks over processes and over a real Dask cluster: each done once, none lost, resumed to the same bytes."""

import multiprocessing
import os
import signal
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError, NumericalError
from bezstab.runs.parallel import KeptResults, completed_chunks
from bezstab.stability.arrays import Arrays
from tests.cli.running import run


@dataclass(frozen=True)
class Job:
    """What a worker is to do: square a number, after having killed itself if it finds a file missing."""

    number: int
    death: Path | None = None
    seconds: float = 0


def square(job: Job) -> Arrays:
    if job.death and not job.death.exists():
        job.death.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if job.number < 0:
        raise InputError(f"at {job.number}")
    time.sleep(job.seconds)
    return {"square": np.array(job.number**2)}


def kept_in(folder: Path) -> KeptResults:
    return KeptResults(folder / "job", "squares")


def arrived(jobs: list[Job], folder: Path, workers: int = 1, scheduler: str | None = None) -> list[int]:
    """Return what all chunks of a job in this folder give, those that are there already included."""
    kept = kept_in(folder)
    found = list(completed_chunks(square, jobs, kept, workers, scheduler))
    assert all(kept.load(number) for number in range(len(jobs)))
    assert sorted(number for number, _ in found) == list(range(len(jobs)))  # each done once
    return [int(dict(found)[number]["square"]) for number in range(len(jobs))]


def test_a_resumed_job_does_only_what_is_missing_or_damaged(tmp_path: Path) -> None:
    kept = kept_in(tmp_path)
    kept.save(1, {"square": np.array(-1)})
    kept.file(2).write_bytes(b"damaged")
    assert arrived([Job(number) for number in range(3)], tmp_path) == [0, -1, 4]  # the second was not done again


@pytest.mark.slow
def test_a_job_gets_workers_of_its_own_right_after_another(tmp_path: Path) -> None:
    for number in range(20):  # workers that are dead without their pool's knowledge met every fourth
        assert arrived([Job(1), Job(2), Job(3)], tmp_path / str(number), workers=2) == [1, 4, 9]


@pytest.mark.slow
def test_a_lost_worker_is_one_line_and_what_is_done_is_kept(tmp_path: Path) -> None:
    jobs = [Job(0), Job(1, tmp_path / "death"), Job(2)]
    kept_in(tmp_path).save(0, {"square": np.array(-9)})
    with pytest.raises(NumericalError, match=r"a worker was lost, .* --resume goes on"):
        arrived(jobs, tmp_path, workers=2)
    assert arrived(jobs, tmp_path, workers=2) == [-9, 1, 4]  # the first was not done again


@pytest.mark.slow
def test_what_a_worker_raises_is_raised_here_at_once_and_no_worker_is_left(tmp_path: Path) -> None:
    begin = time.monotonic()
    with pytest.raises(InputError, match="at -1"):
        arrived([Job(1, seconds=1000), Job(-1)], tmp_path, workers=2)
    assert time.monotonic() - begin < 100
    assert not multiprocessing.active_children()


@pytest.mark.slow
def test_a_cluster_does_the_same_work(tmp_path: Path) -> None:
    """Of real processes: one worker is lost, and replaced, on the way."""
    from distributed import LocalCluster

    jobs = [Job(number, tmp_path / "death" if number == 2 else None) for number in range(6)]
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        assert arrived(jobs, tmp_path, scheduler=address) == [number**2 for number in range(6)]
        assert (tmp_path / "death").exists()
        for more in ("--workers 1", f"--scheduler {address}"):
            run("verify --map 4 --method SYM --scene pendulum --figure none -o", str(tmp_path / more[2:8]), more)
    one, other = tmp_path.glob("*/verify_pendulum_SYM.csv")
    assert one.read_bytes() == other.read_bytes()


def test_nothing_damaged_or_of_another_job_is_taken_for_what_was_kept(tmp_path: Path) -> None:
    kept = kept_in(tmp_path)
    kept.save(0, {"square": np.arange(9)})
    with pytest.raises(InputError, match=r"--resume: .*job is of a run with other options"):
        replace(kept, job="cubes").load(0)
    content = kept.file(0).read_bytes()
    for length in range(0, len(content) // 2, 7):
        kept.file(0).write_bytes(content[:length])
        assert kept.load(0) is None


def test_what_a_killed_run_had_half_written_goes_and_what_is_not_ours_stays(tmp_path: Path) -> None:
    kept = kept_in(tmp_path)
    kept.save(0, {})
    for name in (f".{kept.file(3).name}.0a1b", "mine"):
        (kept.folder / name).touch()
    kept.discard()
    assert [path.name for path in kept.folder.iterdir()] == ["mine"]
