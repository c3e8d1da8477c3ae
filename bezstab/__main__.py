"""Run the command line, as `bezstab` and as `python -m bezstab`."""

try:
    from bezstab.stopping import end_if_told, stop_when_told
except KeyboardInterrupt:  # so early that there is no handler yet; earlier still, the interpreter itself is starting
    import os

    os.write(2, b"bezstab: interrupted\n")
    os._exit(130)

# What a signal does is settled before anything that takes time is imported: on the lines above and below, so nothing
# else stands at the top of this module.


def run() -> None:
    """Run the command line of sys.argv and exit; standard streams that were closed are opened or refused first."""
    try:
        stop_when_told()
        from bezstab.cli.command_group import one_thread_for_algebra, prepare_streams

        one_thread_for_algebra()
        prepare_streams()
        from bezstab.cli.command_group import main

        main()
    finally:
        end_if_told()


if __name__ == "__main__":
    run()
