import pytest

from bezstab.cli.terminal import spelled, visible


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("α̂ = 2αh and β̂ = β²h²", "alpha_hat = 2 alpha h and beta_hat = beta^2 h^2"),
        ("c̈ + 2αċ + β²c = 0", "cddot + 2 alpha cdot + beta^2 c = 0"),
        ("18900 α̂ - 23328", "18900 alpha_hat - 23328"),
        ("predicted ∠z (deg)", "predicted angle z (deg)"),
        ("largest |ċ|", "largest |cdot|"),
        ("0.5 ± 0.1i", "0.5 +- 0.1i"),
        ("s→z, Bézier, Schrödinger", "s->z, Bezier, Schrodinger"),
        ("λ ρ σ μ", "lambda rho sigma mu"),
        ("…“a”", '..."a"'),
        ("中 \N{GRINNING FACE}", "\\u4e2d \\U0001f600"),
        ("plain", "plain"),
    ],
)
def test_what_ascii_lacks_is_spelled(text: str, words: str) -> None:
    assert spelled(text, "ascii") == words


def test_what_an_encoding_has_stays() -> None:
    assert spelled("β² ± é ċ α̂", "latin-1") == "beta² ± é cdot alpha_hat"
    assert spelled("β² ± é ċ α̂", "utf-8") == "β² ± é ċ α̂"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a\nb", "a\\nb"),
        ("\x1b[2J", "\\x1b[2J"),
        ("\u2028", "\\u2028"),
        ("a  é中", "a  é中"),
        ("\x7f\x9b", "\\x7f\\x9b"),
    ],
)
def test_what_would_command_a_terminal_is_shown(text: str, shown: str) -> None:
    assert visible(text) == shown
