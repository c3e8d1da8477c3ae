"""In words: which poles meet at the best point of a method, and where else it is as good."""

from bezstab.stability import BestPoint, FarLimit, pole_place

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


def falling_words(limit: FarLimit) -> str:
    """Return what |z_p| falls towards without a least value, and along which way of alpha_hat and beta_hat."""
    return f"|z_p| falls towards {limit.z_abs:.6g} as {_way(limit)}"


def _way(limit: FarLimit) -> str:
    """Return "β̂ grows at α̂ = 2", or "α̂ and β̂ grow, α̂² = 3 β̂"."""
    (p, q), ratio = limit.direction, limit.ratio
    if p == 0 or q == 0:
        grows, stays = ("α̂", "β̂") if q == 0 else ("β̂", "α̂")
        return f"{grows} grows" + ("" if ratio is None else f" at {stays} = {limit.point(1.0)[q == 0]:.6g}")
    times = "" if ratio is None or f"{ratio:.6g}" == "1" else f"{ratio:.6g} "
    equal = "like" if ratio is None else "="
    if p > 0 and q > 0:
        return f"α̂ and β̂ grow, {_power('α̂', q)} {equal} {times}{_power('β̂', p)}"
    grows, falls, power, other = ("β̂", "α̂", q, -p) if q > 0 else ("α̂", "β̂", p, -q)
    return f"{grows} grows and {falls} falls, {_power(falls, power)} like 1/{_power(grows, other)}"


def _power(name: str, exponent: int) -> str:
    return name if exponent == 1 else f"{name}^{exponent}"


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
