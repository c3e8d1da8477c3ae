"""The command line: parse, call, show, save, exit status.

One file for each group of commands that `bezstab --help` shows; commands with a subject of their own (verify, with its
three ways to measure, lint, probe, schema) have one each beside it. A file imports only from those above it:

    terminal            words for what a terminal cannot show
    completion          what the shell offers after a press of the tab key
    options             parameter types and the options that commands share
    output              rows, files, messages, progress
    asking              the options of a question, and what is said below its answers
    held_drives         drives whose controller is slower than the physics
    accuracy_maps       the map of forced errors over the plane, and the trade against decay
    map_commands        poles, region, methods, family
    choose_commands     choose, check, engines, explore
    chains_command      chains
    evidence_commands   simulate, tradeoff, extremes
    verify_command      verify
    schema_command      schema
    lint_command        lint
    probe_command       probe
    command_group       the group of all commands
"""

from bezstab.cli.command_group import main

__all__ = ["main"]
