"""The paper this tool grew from: what it prints, its runs, its claims, its figures, its command.

An extension: nothing else imports it. `ledger` holds every subject, `command` what is typed.
"""
