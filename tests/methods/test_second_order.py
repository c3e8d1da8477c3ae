"""Second-order schemes: P is what their own step matrix has, what is implicit is found, what cannot be is refused."""

import graphlib
from fractions import Fraction

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods import (
    Assignment,
    Evaluation,
    LinearMultistep,
    Method,
    Quantity,
    SecondOrder,
    closed_loop_at,
    closed_loop_table,
    lookup,
    recipe,
    second_order_form,
    steps,
)
from bezstab.methods.second_order import defect
from tests.methods import kinds
from tests.methods.random_recipes import recipes
from tests.reference.second_order_steps import step_polynomial

F = Fraction
POINTS = [(F(3, 7), F(2, 11)), (F(-1, 3), F(5, 2)), (F(0), F(1)), (F(7, 2), F(0))]


def is_shifted(longer: list[Fraction], shorter: list[Fraction]) -> bool:
    """Return whether one polynomial is the other, made monic, times a power of z."""
    monic = [c / shorter[0] for c in shorter]
    return longer == monic + [F(0)] * (len(longer) - len(monic))


VERLET = {
    "x1": "x0 + v0 + 1/2 a0",
    "vh": "v0 + 1/2 a0",
    "a1": "acceleration(x1, vh)",
    "v1": "vh + 1/2 a1",
}  # fmt: skip


@pytest.mark.promise(
    "P of a second-order scheme",
    proven=(
        "is the characteristic polynomial of the matrix of its own step, of built-in schemes and of random "
        "recipes; the polynomials of the literature come out"
    ),
)
@pytest.mark.parametrize("name", [*kinds.SECOND_ORDER, *(n for n in kinds.MU_METHODS if not n.startswith("B"))])
@pytest.mark.parametrize(("alpha_hat", "beta_hat"), POINTS[:2])
def test_p_is_the_characteristic_polynomial_of_the_step(name: str, alpha_hat: Fraction, beta_hat: Fraction) -> None:
    form = second_order_form(lookup(name).scheme)
    polynomial = step_polynomial(form, alpha_hat, beta_hat)
    assert polynomial is not None
    assert is_shifted(polynomial, closed_loop_at(Method("form", form, ""), alpha_hat, beta_hat))


def has_a_circle(scheme: SecondOrder) -> bool:
    """Return whether some result of the step waits for itself, by Python's own sorting of graphs."""
    results = {equation.result for equation in scheme.equations}
    needed = {equation.result: results & set(equation.used) for equation in scheme.equations}
    try:
        graphlib.TopologicalSorter(needed).prepare()
    except graphlib.CycleError:
        return True
    return False


@pytest.mark.promise("P of a second-order scheme")
@settings(deadline=None, max_examples=60)  # the determinant's time is not bounded by its input's length
@given(recipes(), st.sampled_from(POINTS))
@pytest.mark.slow
def test_p_of_a_random_recipe_is_that_of_its_own_step(
    equations: dict[str, str], point: tuple[Fraction, Fraction]
) -> None:
    scheme = recipe(equations)
    assert scheme.implicit == has_a_circle(scheme)
    p = closed_loop_at(Method("own", scheme, ""), *point)
    polynomial = step_polynomial(scheme, *point)
    assert (polynomial is None) == (p[0] == 0)
    assume(polynomial is not None)
    assert polynomial is not None
    assert is_shifted(polynomial, p)


@settings(deadline=None, max_examples=40)
@given(recipes(), st.sampled_from([F(1, 100), F(-1, 7), F(2)]))
def test_an_acceleration_that_does_not_act_in_full_is_refused(equations: dict[str, str], error: Fraction) -> None:
    more = f" + ({error} a1)"
    with pytest.raises(InputError, match="inconsistent"):
        recipe(equations | {"v1": equations["v1"] + more})


@settings(deadline=None, max_examples=40)
@given(recipes(), st.sampled_from(["x0", "v0", "x[-1]"]))
def test_a_free_motion_that_is_not_followed_is_refused(equations: dict[str, str], quantity: str) -> None:
    with pytest.raises(InputError):
        recipe(equations | {"x1": f"{equations['x1']} + 1/9 {quantity}"})


@settings(deadline=None, max_examples=20)
@given(recipes())
def test_the_order_in_which_equations_are_listed_does_not_matter(equations: dict[str, str]) -> None:
    assert recipe(equations).table == recipe(dict(reversed(equations.items()))).table


@pytest.mark.parametrize(
    ("more", "oldest", "evaluations"),
    [
        ({}, 0, 1),
        ({"v1": "vh + 1/2 a1 + a[-3] - a[-3]"}, 0, 1),
        ({"b": "acceleration(x1, v1)", "v1": "vh + 1/2 a1"}, 0, 2),
    ],
)
def test_steps_and_evaluations_follow_from_the_equations(more: dict[str, str], oldest: int, evaluations: int) -> None:
    scheme = recipe(VERLET | more)
    assert (scheme.oldest, scheme.evaluations) == (oldest, evaluations)


def test_a_value_of_earlier_steps_makes_a_multistep_method() -> None:
    scheme = recipe(VERLET | {"x1": "x0 + v0 + 2/3 a0 - 1/6 a[-1]"})
    assert scheme.oldest == -1
    assert steps(Method("Beeman", scheme, "")) == 2


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"x1": "x0 + v0 + 1/2 a0 + w"}, "x1: no equation gives w"),
        ({"a1": "acceleration(x2, vh)"}, "a1: uses x2, but x1 is the latest there is"),
        ({"w": "x[-21]"}, "w: uses .*: expected at most 20 steps back"),
        ({"w[3]": "x0"}, r"w\[3\]: expected an equation for step 0, 1 or 2"),
        ({"w[-1]": "x0"}, r"w\[-1\]: expected an equation for step 0, 1 or 2"),
        ({"a0": "acceleration(x0, v0)"}, "a0: a second equation for a"),
        ({"x1": "x1"}, "do not determine x1 and v1"),
        ({"x1": "x0 + 2 v0"}, "inconsistent"),
        ({"v1": "vh"}, "an acceleration does not act in full"),
        ({"a1": "acceleration(x1, 2 vh)"}, "feedback not as feedback"),
        ({"a1": "acceleration(2 x1, vh)"}, "feedback not as feedback"),
        ({"x1": "3 x0 - 2 x[-1] - v0 + 1/2 a0"}, "zero-unstable: .* outside the unit circle"),
        ({"w": "w[0] + 0 x0"}, "zero-unstable"),  # a third root z = 1
        ({"w": "2 w[0]"}, "zero-unstable"),  # though nobody needs w
    ],
)
def test_what_cannot_be_is_refused_in_one_line(change: dict[str, str], why: str) -> None:
    with pytest.raises(InputError, match=why) as caught:
        recipe(VERLET | change)
    assert len(str(caught.value).splitlines()) == 1


def test_a_velocity_in_other_units_is_refused_though_p_is_right() -> None:
    doubled = {"x1": "x0 + 1/2 v0", "v1": "v0 + 2 a0", "a0": "acceleration(x0, 1/2 v0)"}
    with pytest.raises(InputError, match="v1 is not the velocity of x1"):
        recipe(doubled)


def test_a_root_on_the_circle_that_stays_is_allowed_once() -> None:
    assert recipe(VERLET | {"w": "0 x0 - w[0]"}).table
    with pytest.raises(InputError, match="zero-unstable"):
        recipe(VERLET | {"w": "0 x0 - w[0] + u[0]", "u": "0 x0 - u[0]"})


@pytest.mark.parametrize("sigma", ["0 2 0", "1/3 4/3 1/3"])  # leapfrog, Milne and Simpson
def test_weakly_stable_multistep_methods_have_second_order_forms(sigma: str) -> None:
    """Their rho = z^2 - 1 has the root -1 once: once for positions, once for velocities, and zero-stable."""
    scheme = LinearMultistep((Fraction(1), Fraction(0), Fraction(-1)), tuple(map(Fraction, sigma.split())))
    form = second_order_form(scheme)
    assert form.table == closed_loop_table(Method("weakly stable", scheme, ""))


def test_x1_and_v1_must_be_given() -> None:
    for name in ("x", "v"):
        left_out = {key: text for key, text in VERLET.items() if not key.startswith(f"{name}1")}
        with pytest.raises(InputError, match=f"no equation gives {name}1|latest"):
            recipe(left_out)


def test_too_many_equations_are_refused() -> None:
    unused = [Assignment(Quantity(f"w{i}", 1), ((F(1), Quantity("x", 0)),)) for i in range(60)]
    with pytest.raises(InputError, match="expected at most 60"):
        SecondOrder((*recipe(VERLET).equations, *unused))


def test_quantities_are_shown_as_they_are_typed() -> None:
    shown = [str(Quantity(*each)) for each in (("x", 1), ("a", 0), ("v", -1), ("vh", 1), ("vh", 0))]
    assert shown == ["x1", "a0", "v[-1]", "vh", "vh[0]"]
    assert Evaluation(Quantity("a", 1), ((F(1), Quantity("x", 1)),), ()).used == (Quantity("x", 1),)


@pytest.mark.parametrize("name", kinds.SECOND_ORDER)
def test_the_responses_have_the_ratio_of_velocity_and_position(name: str) -> None:
    """x and v of the exact motion e^(mu t): v = mu x + O(mu^2), and x = 1 at mu = 0 up to a factor."""
    position, velocity = lookup(name).scheme.responses  # type: ignore[union-attr]
    (at_rest,) = defect(position, 0)
    assert at_rest != 0
    assert defect(velocity, 0) == [0]
    assert defect(velocity, 1) == [at_rest, 0]


def test_the_defect_is_what_an_exact_motion_leaves_over() -> None:
    """P = z - 1 + beta_hat, with z = e^mu, beta_hat = -mu (alpha_hat + mu): mu + (1/2 - 1) mu^2 - mu alpha_hat + ..."""
    table = (((F(-1), F(1)),), ((F(1), F(0)),))
    assert defect(table, 0) == [0]
    assert defect(table, 1) == [1, 0]
    assert defect(table, 2) == [F(-1, 2), -1, 0]
    assert defect(table, 3) == [F(1, 6), 0, 0, 0]
