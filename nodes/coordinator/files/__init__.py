"""Readers of map files, whose type is detected from the content; `schemas/scene_files.py` reads scenes."""
