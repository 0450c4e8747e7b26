"""Recordings of depth cameras as folders of frames, which `semmap perceive --frames` reads."""
