import pytest

from bezstab.methods import lookup
from bezstab.show.best_point_text import best_point_words, falling_words
from bezstab.stability import FarLimit, best_point


def words(name: str) -> str:
    best = best_point(lookup(name))
    assert best
    return best_point_words(best)


@pytest.mark.slow
def test_words_for_the_best_point() -> None:
    assert words("B4") == "z = +0.625884 and -0.625884 meet, each double, on β̂ = α̂²/4"
    assert words("B2").endswith("the same |z_p| on a whole arc, to (0.444444, 0.444444)")
    assert words("RK4") == "deadbeat: every pole is 0; also at (0.541112, 6.347103)"
    assert "-0.140131 ± 0.504013i meet" in words("ABM4")


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        (FarLimit(0.0, (0, 1)), "|z_p| falls towards 0 as β̂ grows"),
        (FarLimit(0.5, (0, 1), 2.0), "|z_p| falls towards 0.5 as β̂ grows at α̂ = 2"),
        (FarLimit(0.5, (1, 0), 2.0), "|z_p| falls towards 0.5 as α̂ grows at β̂ = 0.5"),
        (FarLimit(0.5, (1, 1), 1.0), "|z_p| falls towards 0.5 as α̂ and β̂ grow, α̂ = β̂"),
        (FarLimit(0.5, (1, 2), 3.0), "|z_p| falls towards 0.5 as α̂ and β̂ grow, α̂^2 = 3 β̂"),
        (FarLimit(0.5, (1, 1)), "|z_p| falls towards 0.5 as α̂ and β̂ grow, α̂ like β̂"),
        (FarLimit(0.5, (-1, 2)), "|z_p| falls towards 0.5 as β̂ grows and α̂ falls, α̂^2 like 1/β̂"),
    ],
)
def test_words_for_where_it_falls_towards(limit: FarLimit, words: str) -> None:
    assert falling_words(limit) == words
