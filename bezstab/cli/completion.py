"""Completion in the shell: names of methods, scenes and engines."""

import shlex
from collections.abc import Iterable
from typing import Any

from click.shell_completion import BashComplete, CompletionItem, add_completion_class


@add_completion_class
class QuotingBash(BashComplete):
    """Bash, which would take the parentheses of newmark(1/4,1/2) for its own: what it offers is quoted.

    zsh and fish do that by themselves. A file is no value but the word that bash completes by itself.
    """

    def format_completion(self, item: "CompletionItem[Any]") -> str:
        """Return the line that click's script in bash reads."""
        if item.type != "plain":
            return super().format_completion(item)
        return f"{item.type},{shlex.quote(item.value)}"


def offered(names: Iterable[str], incomplete: str) -> "list[CompletionItem[Any]]":
    """Return those of the names that begin with what was typed, in upper or lower case; files where none does."""
    typed = incomplete.lower()
    fitting: list[CompletionItem[Any]] = [CompletionItem(name) for name in names if name.lower().startswith(typed)]
    return fitting or [CompletionItem(incomplete, type="file")]
