import pytest

from tests.cli.running import rows, run


def test_what_is_thrown_apart_at_once_diverges_and_seconds_are_understood() -> None:
    at = "verify --scene pendulum --method RK4"
    (gone,) = rows(at, "--alpha 14217 --beta 16544")  # |z| = 1.7e15: nothing stays finite
    assert (gone["measured_z_abs"], gone["measured_verdict"], gone["verdicts_agree"]) == (None, "diverges", True)
    # alpha = 400 1/s and beta = 500 1/s: alpha_hat = 2 alpha h, beta_hat = (beta h)^2
    (in_seconds,) = rows(at, "--alpha 400 --beta 500 --h 0.001 --physical")
    assert (in_seconds["alpha_hat"], in_seconds["beta_hat"]) == (0.8, 0.25)
    assert in_seconds["floquet_z_abs"] is None  # nothing exact is computed unless it is asked for


@pytest.mark.parametrize(
    ("scene", "method", "said"),
    [
        ("driven_four_bar", "bdf2", "Exact rates of bdf2: along the motion of the mechanism."),  # implicit
        ("four_bar", "B4", "No rate of B4 is exact: the motion does not begin anew."),
    ],
)
@pytest.mark.slow
def test_exact_rates_are_said_to_be_along_which_motion(scene: str, method: str, said: str) -> None:
    asked = f"verify --scene {scene} --method {method} --alpha 0.5 --beta 0.1 --h 0.01 --floquet"
    assert said in run(asked).stdout.replace("\n", " ")
