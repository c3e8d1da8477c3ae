"""The command line: parse, call, show, save, exit status.

One file for each group of commands that `bezstab --help` shows; verify, with its three ways to measure, has one beside
the other evidence. A file imports only from those above it:

    terminal            words for what a terminal cannot show
    options             parameter types and the options that commands share
    output              rows, files, messages, progress
    moving_mechanism    what several ask about a mechanism that moves
    map_commands        poles, region, methods, family
    choose_commands     choose, check, engines, explore
    evidence_commands   simulate, tradeoff, extremes
    verify_command      verify
    command_group       the group of all commands
"""

from bezstab.cli.command_group import main

__all__ = ["main"]
