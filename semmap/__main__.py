"""`python -m semmap`: the command line."""

from nodes.extern.cli.app import main

main()
