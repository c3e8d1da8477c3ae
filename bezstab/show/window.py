"""Figures of the plane in a window: what the point under the mouse means."""

from collections.abc import Callable, Sequence
from fractions import Fraction

from matplotlib.figure import Figure

from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.show.style import plane_coordinates, styled
from bezstab.stability.closed_loop import spectral_radius, verdict
from bezstab.words import point_words

ENLARGED = 2  # times the size of a column on paper


def under_the_mouse(methods: Sequence[Method], h: Fraction | float | None) -> Callable[[float, float], str]:
    """Return what a window says of a place on axes as `plane_words` has them, for a step of h (s): `format_coord`.

    The point has six digits; of each method |z_p| and the verdict, which is proven for these digits.
    """
    units = plane_coordinates(1.0, 1.0, h)

    def words(x: float, y: float) -> str:
        alpha_hat, beta_hat = (Fraction(f"{at / unit:.6g}") for at, unit in zip((x, y), units, strict=True))
        lines = [point_words(float(alpha_hat), float(beta_hat), h)]
        for method in methods:
            z_abs = float(spectral_radius(method, float(alpha_hat), float(beta_hat)))
            lines.append(f"{method.name}: |z_p| = {z_abs:.6f}, {verdict(method, alpha_hat, beta_hat)} (proven)")
        return "\n".join(lines)

    return words


def show_in_window(figure: Figure) -> None:
    """Open a window on the figure and return once it is closed; InputError if there is none to open."""
    from matplotlib import pyplot

    with styled():
        try:
            pyplot.figure(FigureClass=lambda *_, **__: figure)  # type: ignore[arg-type]  # which is made already
        except ImportError as error:
            raise InputError(f"--figure window: {error}") from None
        if figure.canvas.required_interactive_framework is None:
            pyplot.close(figure)
            raise InputError("--figure window: matplotlib found no window system (try another MPLBACKEND, or a screen)")
        figure.set_dpi(ENLARGED * figure.dpi)
        pyplot.show()
