"""The command line: it begins in `app.py`; `verbs.py` gathers the verbs.

`talking.py` is what they share, `show.py` the looks.
"""
