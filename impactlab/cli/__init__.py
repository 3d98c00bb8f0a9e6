"""The command line: each command parses, calls one function and prints.

Heavy imports wait until a command needs them.
"""

from impactlab.cli.interrupt import stop_without_more, stopped


def main() -> None:
    """Run the command line, see impactlab.cli.app.main; Ctrl-C ends it from the start."""
    stop_without_more()
    from impactlab.cli.app import main

    try:
        main()
    finally:
        stopped()
