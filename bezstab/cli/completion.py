"""Completion in the shell: what bash needs beside click's own; the types of options say what is offered."""

import shlex
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
