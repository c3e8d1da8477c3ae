"""The area of a region that is known to be bounded, as a number."""

from bezstab.methods.schemes import Method
from bezstab.stability.regions import region


def region_area(method: Method, level: float = 1.0) -> float:
    """Return the area of |z_p| < level; AssertionError if there is none."""
    area = region(method, level).area
    assert area is not None
    return area
