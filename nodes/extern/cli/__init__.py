"""The command line: `app.py` gathers the verbs, `talking.py` is what they share, `show.py` the looks."""
