"""Which cases of a test are left to `make test-slow`: see the marks in pyproject.toml."""

import pytest


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark as slow each case of a test with the mark slow_except whose name begins with none of what the mark names."""
    for item in items:
        quick = item.get_closest_marker("slow_except")
        if quick is None:
            continue
        case = item.name.partition("[")[2].rstrip("]")
        if not case.startswith(quick.args):
            item.add_marker(pytest.mark.slow)
