"""Files that say what stands where, told apart by content; JSON scenes are schemas/scene_files.py."""
