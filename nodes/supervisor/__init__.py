"""Starts, watches and stops the processes: `semmap up`, `semmap down`, `semmap node`.

`settings.py` defines the settings, `launch.py` runs one node in this process, `control.py` controls
supervisord, and `up.py` is the foreground process.
"""
