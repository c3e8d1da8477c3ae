"""The page of promises (promises.md) is what the marks of the tests say, and nothing else."""

from tests import promises


def test_the_page_is_fresh() -> None:
    assert promises.PAGE.read_text(encoding="utf-8") == promises.page()
