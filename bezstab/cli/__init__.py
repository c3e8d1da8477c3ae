"""The command line."""

from bezstab.cli.main import main

__all__ = ["main"]
