"""Several robots: queried together, or mirrored into one SPARQL server and queried there.

with semmap.fleet.robots("arm*") as robots:
    for answer in robots.list("Cup"):
        print(answer.robot, answer.commit, answer.value)
"""

from semmap.nodes.extern.fleet.frames import Frame
from semmap.nodes.extern.fleet.mirror import Mirror
from semmap.nodes.extern.fleet.mirror_config import mirror
from semmap.nodes.extern.fleet.query import CopiedRobot, FleetAnswer, sparql
from semmap.nodes.extern.fleet.robots import Robots, robots
from semmap.schemas.robots import Answer

__all__ = ["Answer", "CopiedRobot", "FleetAnswer", "Frame", "Mirror", "Robots", "mirror", "robots", "sparql"]
