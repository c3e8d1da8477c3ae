"""Directories of finished chunks: every damage is seen, one run at a time, nothing but what is known is removed."""

import multiprocessing
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.evidence.chunk_stores import ChunkStore, chunk_store
from tests.evidence.samples import of_campaign

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
