"""`python -m kshell`, the same as the command `kshell`."""

from kshell.cli import main

main()
