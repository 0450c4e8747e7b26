"""The shapes of things as they stand: solids, their convex parts, outlines from above."""
