"""Processes that work for others, and clusters that do not answer: how they end."""

import time

import pytest

from bezstab.errors import InputError
from bezstab.evidence import worker_pool


def test_busy_workers_are_ended_at_once_where_nobody_waits_for_them() -> None:
    with worker_pool(1) as workers:
        busy = workers.start().submit(time.sleep, 1000)
    with pytest.raises(workers.lost):
        busy.result(timeout=60)


def test_a_scheduler_that_does_not_answer_is_one_line() -> None:
    with pytest.raises(InputError, match="--scheduler nonsense"), worker_pool(scheduler="nonsense://x"):
        pass
