"""A recorder of trails with simulated clocks, in a flat of two rooms."""

from __future__ import annotations

from types import SimpleNamespace

from semmap.nodes.kb_node.answers.past import trails
from semmap.nodes.kb_node.answers.past.trail_recording import TrailRecorder
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.trail_file import TrailFile, read_lines
from semmap.schemas.commands import FindTrail
from semmap.schemas.entities import Live, Pose
from semmap.schemas.live import LivePoses
from semmap.schemas.moments import read_moment
from tests.kb_node.relations.entities import thing

S = 1_000_000_000
BEGIN = 1_700_000_000 * S
ROOMS = [
    thing("hall1", (0.0, 0.0, 0.0), size=(4.0, 4.0, 3.0), place=True),
    thing("kitchen1", (4.0, 0.0, 0.0), size=(4.0, 4.0, 3.0), place=True),
    thing("flat1", (2.0, 0.0, 0.0), size=(8.0, 4.0, 3.0), place=True),
]
PAST = SimpleNamespace(moment=read_moment)
PRESENT = [*ROOMS, thing("r1", (0.0, 0.0, 0.0), "box", size=(0.4, 0.4, 0.4)), thing("cup1", (0.0, 0.0, 0.0))]


class Recording:
    """A recorder with clocks of its own, in steps of 0.1 s; the wall clock can be set back."""

    def __init__(self, folder, **options):
        self.folder, self.now_ns, self.problems = folder, BEGIN, []
        self.set_back_ns = 0
        self.version = 1
        self.begin(**options)

    def begin(self, **options):
        self.space = Space(ROOMS)
        self.recorder = TrailRecorder(
            TrailFile(self.folder, **options),
            lambda: (self.version, self.space.solids.values(), Thresholds()),
            self.problems.append,
            lambda: self.now_ns,
            lambda: self.now_ns - self.set_back_ns,
        )

    def publish(self, **at):
        live = {
            name: Live(pose=Pose(position_m=position), stamp_ns=1, age_s=0.0, source="stream")
            for name, position in at.items()
        }
        self.recorder.update(LivePoses(stamp_ns=1, entities=live))

    def drive(self, start_x, end_x, seconds, name="r1"):
        for i in range(seconds * 10):
            x = start_x + (end_x - start_x) * (i + 1) / (seconds * 10)
            self.now_ns += S // 10
            self.publish(**{name: (x, 0.0, 0.0)})
            if i % 10 == 9:
                self.recorder.write()

    def wait(self, seconds):
        for _ in range(seconds):
            self.now_ns += S
            self.recorder.write()

    def ask(self, name="r1", **fields):
        self.recorder.write()
        return trails.find_trail(
            read_lines(self.folder),
            PAST,
            PRESENT,
            FindTrail(name=name, **fields),
            self.now_ns - self.set_back_ns,
        )
