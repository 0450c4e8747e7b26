"""The past of a map: filmed, run again, and compared with a recording of it.

    from semmap.recordings import Film, movie

    movie("morning.mp4", Film(since="08:00", until="09:00", speed=10.0), data="maps/flat")

Each reads the journal of a data folder, or of a running system, and changes nothing.
"""

from semmap.nodes.extern.movie import Film, movie
from semmap.nodes.extern.replay import check, replay

__all__ = ["Film", "check", "movie", "replay"]
