"""What a cell of a table shows where it takes more than a format: texts made of a row."""

from bezstab.show.fields import MISSING, Row, formatted

MOST_FIXED = 1e6  # a modulus from here on is shown with an exponent

LIMITS = ("alpha_hat_min", "alpha_hat_max", "beta_hat_min", "beta_hat_max")
"""The ends of a region's ranges, as rows name them."""

SPINNING = {
    "acceleration": "gains, as θ⁴",
    "bias": "loses, as θ⁴",
    "beside": "loses θ² a step",
    "projected": "loses 2θ² a step",
}
"""What becomes of the energy of a body that spins by θ in a step, by the class of an engine."""

NAMES_ROOM = 22
"""Letters of the longest name in the list of methods."""


def pole_words(pole: complex) -> str:
    """Return a pole and its conjugate, or a real one: 0.762694 ± 0.142074i."""
    form = ".6f" if max(abs(pole.real), pole.imag) < MOST_FIXED else ".6e"
    visible = round(pole.imag / max(1, abs(pole.real)), 6) != 0
    return f"{pole.real:{form}} ± {pole.imag:{form}}i" if visible else f"{pole.real:{form}}"


def modulus_words(modulus: float) -> str:
    """Return |z|: six decimals, or an exponent where it is huge."""
    return formatted(modulus, ".6e" if abs(modulus) >= MOST_FIXED else ".6f")


def unbounded(row: Row) -> str:
    """Return what is said of a region's area or of an end that it does not have: unbounded, unless it is empty."""
    return MISSING if row.get("bounded", True) else "unbounded"
