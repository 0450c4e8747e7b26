"""The command line: `app.py` is the entry point, `all_verbs.py` lists the verbs.

`calling.py` is what the verbs share, `output/` formats replies, `completing.py` completes words in a shell.
"""
