"""In words: which poles meet at the best point of a method, and where else it is as good."""

from bezstab.stability import BestPoint, pole_place

TIMES = {2: "double", 3: "triple"}


def best_point_words(best: BestPoint) -> str:
    """Return in words which poles meet at the best point, and where else |z_p| is as small (dimensionless, as text)."""
    if best.fixed is not None and best.z_abs <= abs(best.fixed):
        return f"a pole stays at {pole_place(best.fixed)} whatever α̂ and β̂"
    words = _poles_in_words(best)
    points = " and ".join(f"({alpha_hat:.6f}, {beta_hat:.6f})" for alpha_hat, beta_hat in best.elsewhere)
    if best.arc:
        words += f"; the same |z_p| on a whole arc, to {points}"
    elif points:
        words += f"; also at {points}"
    if best.fixed is not None:
        words += f"; a pole stays at {pole_place(best.fixed)} whatever α̂ and β̂"
    return words


def _poles_in_words(best: BestPoint) -> str:
    if best.z_abs == 0:
        return "deadbeat: every pole is 0"
    words = f"z = {' and '.join(_pole_text(z) for z in best.meeting)}"
    if len(best.meeting) > 1:
        words += " meet"
    if best.multiplicity > 1:
        words += f", {'each ' if len(best.meeting) > 1 else ''}{TIMES.get(best.multiplicity, 'multiple')}"
    if best.double:
        words += ", each double, on β̂ = α̂²/4"
    return words


def _pole_text(z: complex) -> str:
    """Return +0.625884, or -0.140131 ± 0.504013i for a pair."""
    return f"{z.real:+.6f} ± {z.imag:.6f}i" if z.imag else f"{z.real:+.6f}"
