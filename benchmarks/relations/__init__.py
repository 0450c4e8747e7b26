"""Spatial relations compared with MuJoCo's contacts and with manual annotations of the flat."""
