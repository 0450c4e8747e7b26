"""Views: the segments of each camera, and the things that all cameras show together."""
