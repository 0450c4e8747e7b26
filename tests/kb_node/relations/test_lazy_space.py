"""The space of a map is built and updated when it is read."""

from __future__ import annotations

from semmap.nodes.kb_node.relations.lazy_space import LazySpace
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from tests.kb_node.relations.entities import TABLE, thing


class Map:
    """Entities by name, and which of them were read."""

    def __init__(self):
        self.entities = {"table1": TABLE, "cup1": thing("cup1", (0.0, 0.0, 0.0))}
        self.limits = Thresholds()
        self.reads = []
        self.lazy = LazySpace(self.read_all, self.find, lambda: self.limits)

    def read_all(self):
        self.reads.append("all")
        return self.entities.values()

    def find(self, name):
        self.reads.append(name)
        return self.entities.get(name)


def test_nothing_is_read_before_the_first_access_and_everything_then():
    of = Map()
    of.lazy.mark_changed(["cup1"])
    assert of.reads == []
    assert of.lazy.space().solids.keys() == {"table1", "cup1"}
    assert of.reads == ["all"]


def test_only_what_has_changed_is_read_again_and_only_once():
    of = Map()
    of.lazy.space()
    of.entities["cup1"] = thing("cup1", (1.0, 2.0, 0.0))
    of.lazy.mark_changed(["cup1"])
    of.lazy.mark_changed(["cup1"])
    assert of.lazy.space().solids["cup1"].position == (1.0, 2.0, 0.0)
    of.lazy.space()
    assert of.reads == ["all", "cup1"]


def test_a_removed_entity_has_no_solid_and_an_added_one_has():
    of = Map()
    of.lazy.space()
    del of.entities["cup1"]
    of.entities["cup2"] = thing("cup2", (1.0, 2.0, 0.0))
    of.lazy.mark_changed(["cup1", "cup2"])
    assert of.lazy.space().solids.keys() == {"table1", "cup2"}


def test_other_thresholds_build_a_space_with_them():
    of = Map()
    of.lazy.space()
    of.limits = Thresholds(gap_m=of.limits.gap_m * 2.0)
    assert of.lazy.space().limits is of.limits
    assert of.reads == ["all", "all"]
