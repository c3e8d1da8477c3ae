"""Run the command line, as `bezstab` and as `python -m bezstab`."""

from bezstab.stopping import end_when_told, ignore_signals

# What a signal does is settled before anything that takes time is imported: on the line above and the lines below,
# so nothing else stands at the top of this module.


def run() -> None:
    """Run the command line of sys.argv and exit; standard streams that were closed are opened or refused first."""
    end_when_told()
    from bezstab.cli.terminal import prepare_streams

    prepare_streams()
    from bezstab.cli import main

    try:
        main()
    finally:
        ignore_signals()


if __name__ == "__main__":
    run()
