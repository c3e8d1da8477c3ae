import numpy as np
import pytest

from bezstab.stability.shapes import joined


def test_edges_given_either_way_round_are_joined_into_one_closed_curve() -> None:
    corners = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]])
    sides = [np.linspace(corners[k], corners[(k + 1) % 4], 9) for k in range(4)]
    for turned in range(16):
        edges = [side[::-1] if turned >> k & 1 else side for k, side in enumerate(sides)]
        (curve,) = joined(edges, most=1e-9)
        x, y = curve.T
        assert abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) == pytest.approx(6, rel=1e-14)  # twice the area


def test_what_does_not_meet_stays_open() -> None:
    corner = np.array([[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]])
    (curve,) = joined([corner[1:], corner[1::-1]], most=1e-9)
    assert len(curve) == 4
    assert len(joined([corner, corner + 2], most=1e-9)) == 2
