from bezstab.methods import lookup
from bezstab.show.best_point_text import best_point_words
from bezstab.stability import best_point


def words(name: str) -> str:
    best = best_point(lookup(name))
    assert best
    return best_point_words(best)


def test_words_for_the_best_point() -> None:
    assert words("B4") == "z = +0.625884 and -0.625884 meet, each double, on β̂ = α̂²/4"
    assert words("B2").endswith("the same |z_p| on a whole arc, to (0.444444, 0.444444)")
    assert words("RK4") == "deadbeat: every pole is 0; also at (0.541112, 6.347103)"
    assert "-0.140131 ± 0.504013i meet" in words("ABM4")
