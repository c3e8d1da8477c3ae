"""Run the command line as `python -m bezstab`."""

from bezstab.cli import main

main()
