"""The Pareto front against its definition."""

from hypothesis import given
from hypothesis import strategies as st

from bezstab.evidence import pareto_front
from tests.reference.undominated import Point, undominated

points_of_a_sweep = st.lists(st.tuples(st.floats(1, 9), st.one_of(st.none(), st.floats(1, 9))))


@given(points_of_a_sweep)
def test_the_front_is_what_no_pair_excludes_by_ascending_cost(points: list[Point]) -> None:
    front = [points[k] for k in pareto_front(points)]
    assert set(front) == undominated(points)
    assert front == sorted(set(front))
