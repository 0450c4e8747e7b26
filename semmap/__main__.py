"""`python -m semmap`: the command line."""

from semmap.nodes.extern.cli.app import main

main()
