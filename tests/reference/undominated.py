"""The Pareto front by its definition: every pair compared."""

from collections.abc import Sequence

Point = tuple[float, float | None]


def beats(one: Point, other: Point) -> bool:
    """Return whether one point is as cheap and as accurate as another, and not the same."""
    if one[1] is None or other[1] is None:
        return False
    return one[0] <= other[0] and one[1] <= other[1] and one != other


def undominated(points: Sequence[Point]) -> set[Point]:
    """Return the points (cost, error) with an error that no other beats."""
    return {point for point in points if point[1] is not None and not any(beats(other, point) for other in points)}
