"""`python -m kshell`, the same as the command `kshell`."""

from kshell.cli.commands import main

main()
