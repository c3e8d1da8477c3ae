"""The command line."""

from bezstab.cli.commands import main

__all__ = ["main"]
