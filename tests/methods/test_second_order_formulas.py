from fractions import Fraction

from bezstab.methods.formulas import second_order_text
from bezstab.methods.recipes import recipe


def written(equations: dict[str, str], multiple: str = "1", latex: bool = False) -> str:
    return second_order_text(recipe(equations), Fraction(multiple), latex)


def test_each_derivative_more_is_a_power_of_the_step() -> None:
    squared = {"x1": "x0 + v0 + 1/2 a0", "v1": "v0 + 1/2 a0 + 1/2 a1", "a1": "acceleration(x1, v1)"}
    assert written(squared, "2").startswith("x_{k+1} = x_k + 2 h v_k + 2 h^2 a_k; ")


def test_a_velocity_from_positions_is_divided_by_h() -> None:
    stoermer = {"a0": "acceleration(x0, x0 - x[-1])", "x1": "2 x0 - x[-1] + a0", "v1": "x1 - x0"}
    assert written(stoermer) == (
        "a_k = a(x_k, 1/h x_k - 1/h x_{k-1}); x_{k+1} = 2 x_k - x_{k-1} + h^2 a_k; v_{k+1} = 1/h x_{k+1} - 1/h x_k"
    )
    assert r"\frac{1}{2 h} x_k" in written(stoermer, "2", latex=True)


def test_a_helper_has_its_step_and_the_least_derivative_of_its_sum() -> None:
    later = {"x1": "x0 + d", "d": "v0 + 1/2 a0", "v1": "v0 + a0", "a0": "acceleration(x0, v0)"}
    assert "d = v_k + h/2 a_k" in written(later)
    smoothed = {"a0": "acceleration(x0, v0)", "w_m": "1/2 w_m[0] + 1/2 a0", "v1": "v0 + w_m", "x1": "x0 + v1"}
    assert "w_m_{k+1} = 1/2 w_m_k + 1/2 a_k" in written(smoothed)
    assert r"\mathrm{w\_m}_{k+1} = \frac{1}{2} \mathrm{w\_m}_k + \frac{1}{2} a_k" in written(smoothed, latex=True)
