"""The command line: parse, ask, show, save, exit status.

One file for each group of commands that `bezstab --help` shows; commands with a subject of their own (verify, with its
three ways to measure, lint, probe, schema) have one each beside it.
"""

from bezstab.cli.command_group import main

__all__ = ["main"]
