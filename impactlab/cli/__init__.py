"""The command line: one command a file, which parses, calls and prints.

Heavy imports wait until a command needs them.
"""

from impactlab.cli.app import main

__all__ = ["main"]
