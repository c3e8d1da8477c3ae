"""The command line: parse, ask, show, save, exit status.

One file for each command. It names the options that it takes (`options` has those that several commands share), asks a
question (`asking`), and shows the answers (`output`). It returns whether what it judges is safe, or an exit status.
"""
