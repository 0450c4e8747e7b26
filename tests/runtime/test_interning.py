import msgspec

from semmap.nodes.runtime.interning import EntityInterner
from semmap.schemas.entities import IDENTITY, Entity
from tests.recorder.messages import entity


def decoded(like):
    return msgspec.msgpack.decode(msgspec.msgpack.encode(like), type=Entity)


def test_equal_parts_are_one_object_and_nothing_else_is_changed():
    shared = EntityInterner()
    a, b = (shared.entity(decoded(entity(name, "Cup"))) for name in ("a", "b"))
    assert (a, b) == (entity("a", "Cup"), entity("b", "Cup"))
    assert a.types is b.types
    assert a.class_ is b.class_
    assert a.provenance is b.provenance is a.shape_provenance
    assert a.pose is None or a.pose.orientation_wxyz is IDENTITY


def test_another_commit_has_another_provenance():
    shared = EntityInterner()
    said = entity("a", "Cup")
    later = msgspec.structs.replace(
        said, pose_provenance=msgspec.structs.replace(said.provenance, commit=said.provenance.commit + 1)
    )
    shared.entity(decoded(said))
    assert shared.entity(decoded(later)) == later
