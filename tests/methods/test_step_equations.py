"""In which order the equations of a step can be taken, and which wait for each other."""

from bezstab.methods import recipe

VERLET = {
    "x1": "x0 + v0 + 1/2 a0",
    "vh": "v0 + 1/2 a0",
    "a1": "acceleration(x1, vh)",
    "v1": "vh + 1/2 a1",
}  # fmt: skip


def test_equations_are_taken_when_what_they_need_is_there() -> None:
    backwards = recipe(dict(reversed(VERLET.items())))
    taken = [[str(equation.result) for equation in group] for group in backwards.groups]
    assert taken.index(["vh"]) < taken.index(["a1"]) < taken.index(["v1"])
    assert taken.index(["x1"]) < taken.index(["a1"])
    assert not backwards.implicit


def test_equations_in_a_circle_are_taken_together() -> None:
    scheme = recipe(VERLET | {"a1": "acceleration(x1, v1)"})
    assert [{str(equation.result) for equation in group} for group in scheme.groups] == [{"x1"}, {"vh"}, {"a1", "v1"}]
    assert scheme.implicit


def test_an_equation_that_uses_its_own_result_is_implicit() -> None:
    assert recipe({"a0": "acceleration(x0 + v0, v0 + a0)", "v1": "v0 + a0", "x1": "x0 + v1"}).implicit


def test_two_circles_are_two_groups() -> None:
    scheme = recipe({
        "p": "1/2 q + 1/2 v0",
        "q": "1/2 p + 1/2 v0",
        "x1": "x0 + p",
        "v1": "v0 + a1",
        "a1": "acceleration(x1, v1)",
    })  # fmt: skip
    assert [{str(equation.result) for equation in group} for group in scheme.groups] == [
        {"p", "q"},
        {"x1"},
        {"v1", "a1"},
    ]
