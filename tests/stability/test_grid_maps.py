import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import dominant_pole, pole_map
from tests.reference.companion_poles import radius


@pytest.mark.parametrize(("name", "columns", "rows"), [("AB3", 57, 1201), ("RK4", 1, 5), ("SYM", 70000, 2)])
def test_the_map_is_the_dominant_pole_on_the_mesh(name: str, columns: int, rows: int) -> None:
    method, a, b = lookup(name), np.linspace(-0.2, 1.1, columns), np.linspace(0.01, 0.6, rows)
    stacked = np.concatenate(list(pole_map(method, a, b)))
    assert stacked.shape == (rows, columns)
    assert np.abs(stacked - dominant_pole(method, a, b[:, None])).max() < 1e-9  # other starts of the iteration
    assert (np.abs(stacked[::97, ::7]) - radius(method, *np.meshgrid(a, b))[::97, ::7]).max() < 1e-6
