"""The history of a map: export as video, replay, and comparison with a recording.

    from semmap.recordings import Film, movie

    movie("morning.mp4", Film(since="08:00", until="09:00", speed=10.0), data="maps/flat")

All functions read the journal of a data folder or of a running system and do not change it.
"""

from semmap.nodes.extern.movie import Film, movie
from semmap.nodes.extern.replay import check, replay

__all__ = ["Film", "check", "movie", "replay"]
