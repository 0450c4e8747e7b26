"""The command line.

`app.py` is the entry point, `all_commands.py` lists the commands, and `common.py` has their common options.
`output/` formats replies, and `shell_completion.py` completes words in a shell.
"""
