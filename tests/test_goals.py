from typing import get_args

import bezstab
from bezstab.goals import GOALS, Goal


def test_every_goal_says_what_it_asks_for_and_can_be_chosen() -> None:
    assert tuple(GOALS) == get_args(Goal)
    for goal in GOALS:
        settle = 1 if goal == "gentle" else None
        assert bezstab.choose("SYM", goal=goal, h=0.01, settle=settle).goal == goal
