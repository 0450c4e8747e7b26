"""Conversion of recordings of depth cameras to frame folders, which `semmap perceive --frames` reads."""
