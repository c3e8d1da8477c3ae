from fractions import Fraction

import mpmath as mp
import pytest

from bezstab.methods import REGISTRY, STEP_FAMILIES, accuracy, lookup
from bezstab.stability import bezier_limit, family_members


def test_members_are_the_registered_methods_with_their_known_areas() -> None:
    found = family_members("bezier", 2, 4) + family_members("adams-bashforth", 3, 4)
    assert [member.method for member in found] == [lookup(name) for name in ("B2", "B3", "B4", "AB3", "AB4")]
    areas = (1.0792066831172, 0.8867074265353, 0.8096847183719, 0.3822792180494, 0.0649115455705)
    assert [member.region.area for member in found] == pytest.approx(areas, abs=1e-12)
    assert [(member.order, member.error_constant) for member in found] == [accuracy(member.method) for member in found]
    prefixes = {"bezier": "B", "adams-bashforth": "AB"}
    assert all(f"{prefixes[name]}{family.largest}" in REGISTRY for name, family in STEP_FAMILIES.items())


@pytest.mark.slow
def test_the_limits_numbers_to_thirty_digits() -> None:
    limit = bezier_limit()
    with mp.workdps(30):

        def mu(z: mp.mpc) -> mp.mpc:
            return (z - 1) ** 2 / (z * mp.expm1((z - 1) / z))

        length = -mp.re(mu(mp.mpc(-1)))
        assert limit.alpha_hat_max == pytest.approx(float(2 * length), abs=1e-14)

        def density(theta: mp.mpf) -> mp.mpf:
            return 2 * mp.im(mu(mp.expj(theta))) ** 2 * mp.diff(lambda t: mp.re(mu(mp.expj(t))), theta)

        area = abs(mp.quad(density, mp.linspace(0, mp.pi, 9))) + length**3 / 6
        assert limit.area == pytest.approx(float(area), abs=1e-12)
        r = mp.findroot(lambda r: mu(mp.mpc(r)).real - mu(mp.mpc(-r)).real, 0.687)
        assert limit.z_abs == pytest.approx(float(r), abs=1e-14)
    assert limit.error_constant == Fraction(1, 4)
