from tests.cli.conftest import _in_an_empty_directory  # noqa: F401
