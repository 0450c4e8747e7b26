"""Starts, watches and stops the processes: `semmap up`, `semmap down`, `semmap node`.

`settings.py` is what one may set, `launch.py` runs one node in this process, `control.py` is supervisord,
`up.py` is the foreground.
"""
