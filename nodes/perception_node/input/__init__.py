"""Input: frames and point clouds from cameras and files."""
