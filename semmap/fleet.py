"""Several robots: asked together.

with semmap.fleet.robots("arm*") as robots:
    for answer in robots.list("Cup"):
        print(answer.robot, answer.commit, answer.value)
"""

from nodes.extern.fleet.robots import Robots, robots
from schemas.robots import Answer

__all__ = ["Answer", "Robots", "robots"]
