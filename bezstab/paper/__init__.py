"""The paper this tool grew from: what it prints, its runs, its claims, its figures, its command.

An extension: nothing outside imports it, the command line finds its command by name.
"""
