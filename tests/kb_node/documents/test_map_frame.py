import math

import pytest

from semmap.nodes.kb_node.documents import map_frame, rdf
from semmap.nodes.kb_node.entities import aligned_values, alignments
from semmap.schemas import errors
from semmap.schemas.entities import Pose

SOMA = [known for known in alignments.shipped() if known.title.startswith("SOMA")]
HEAD = """@prefix : <http://e.org/k#> . @prefix soma: <http://www.ease-crc.org/ont/SOMA.owl#> .
@prefix knowrob: <http://knowrob.org/kb/knowrob.owl#> .
"""
TURNED = "0 0 0.7071067811865476 0.7071067811865476"  # a quarter turn about z


def pose(name, xyz, xyzw="0 0 0 1", reference=""):
    relative = f"; knowrob:relativeTo :{reference}" if reference else ""
    return (
        f":{name} soma:hasLocalization [ soma:hasSpaceRegion [ knowrob:translation '{xyz}' ;"
        f" knowrob:quaternion '{xyzw}' {relative} ] ] .\n"
    )


def matrix(name, rows):
    numbers = [f"knowrob:m{i}{j} {float(x)}" for i, row in enumerate(rows) for j, x in enumerate(row)]
    return f":{name} a knowrob:RotationMatrix3D ; {' ; '.join(numbers)} .\n"


def perception(name, thing, at, time=""):
    since = f"; knowrob:startTime :timepoint_{time}" if time else ""
    return f":{name} a knowrob:SemanticMapPerception ; knowrob:objectActedOn :{thing} ; knowrob:eventOccursAt :{at} {since} .\n"  # noqa: E501


AT = [[0, -1, 0, 1.4], [1, 0, 0, 0.9], [0, 0, 1, 0.75], [0, 0, 0, 1]]


def converted(turtle, find_frame=lambda _: None):
    triples = rdf.parse((HEAD + turtle).encode(), "f")
    found, notes = map_frame.express_in_map_frame(triples, SOMA, find_frame)
    about = {}
    for s, p, o in found:
        about.setdefault(s, {}).setdefault(p, []).append(o)
    poses = {}
    for s in about:
        (at,) = [*aligned_values.find_poses(SOMA, lambda t: about.get(t, {}), s)] or [None]
        if at is not None:
            poses[s.partition("#")[2][:-1]] = (*at.position, *(round(x, 3) for x in at.orientation))
    return poses, notes


def test_a_perception_gives_the_pose_of_its_object():
    poses, notes = converted(perception("p", "fridge", "m") + matrix("m", AT))
    assert poses == {"fridge": (1.4, 0.9, 0.75, 0.707, 0.0, 0.0, 0.707)}
    assert notes == ["1 pose read from perceptions: fridge"]


def test_the_latest_perception_counts():
    later = [[*row[:3], row[3] + 1] for row in AT]
    turtle = perception("a", "fridge", "m", "1361536700.5") + matrix("m", later)
    turtle += perception("b", "fridge", "n", "1361536619") + matrix("n", AT)
    assert converted(turtle)[0]["fridge"][:3] == (2.4, 1.9, 1.75)


def test_a_perception_may_occur_at_a_pose_of_another_form():
    turtle = (
        perception("p", "fridge", "at") + f":at knowrob:translation '1 2 3' ; knowrob:quaternion '{TURNED}' ."
    )
    assert converted(turtle)[0]["fridge"] == (1.0, 2.0, 3.0, 0.707, 0.0, 0.0, 0.707)


def test_a_stated_pose_counts_more_than_a_perception():
    poses, notes = converted(pose("fridge", "1 2 3") + perception("p", "fridge", "m") + matrix("m", AT))
    assert (poses["fridge"][:3], notes) == ((1.0, 2.0, 3.0), [])


@pytest.mark.parametrize("wrong", [[[2, 0, 0, 1], *AT[1:]], AT[:2], [AT[1], AT[0], AT[2]]])
def test_a_matrix_that_is_not_a_pose_gives_none(wrong):
    assert converted(perception("p", "fridge", "m") + matrix("m", wrong)) == ({}, [])


def test_the_same_document_gives_the_same_nodes():
    turtle = (HEAD + perception("p", "fridge", "m") + matrix("m", AT)).encode()
    first, second = (map_frame.express_in_map_frame(rdf.parse(turtle, "f"), SOMA)[0] for _ in "ab")
    assert first == second


def test_relative_poses_are_composed_along_the_chain():
    turtle = pose("fridge", "1 2 0.5", TURNED) + pose("door", "0.3 0 0", TURNED, "fridge")
    turtle += pose("handle", "0.1 0 0", "0 0 0 1", "door")
    poses, notes = converted(turtle)
    assert poses["door"] == pytest.approx((1.0, 2.3, 0.5, 0.0, 0.0, 0.0, 1.0), abs=1e-3)
    assert poses["handle"] == pytest.approx((0.9, 2.3, 0.5, 0.0, 0.0, 0.0, 1.0), abs=1e-3)
    assert notes == ["2 relative poses stored in the map frame: door and handle"]


def test_a_pose_may_be_relative_to_a_perceived_thing():
    turtle = perception("p", "fridge", "m") + matrix("m", AT) + pose("handle", "0.1 0 0", "0 0 0 1", "fridge")
    assert converted(turtle)[0]["handle"] == (1.4, 1.0, 0.75, 0.707, 0.0, 0.0, 0.707)


def test_a_pose_may_be_relative_to_an_entity_of_the_map_or_to_the_map():
    def find_frame(iri):
        return Pose(position_m=(5.0, 0.0, 0.0)) if "fridge" in iri else None

    turtle = pose("handle", "0.1 0 0", reference="fridge") + pose("cup", "0.1 0 0", reference="map")
    poses, _ = converted(turtle, find_frame)
    assert (poses["handle"][0], poses["cup"][0]) == (5.1, 0.1)


def test_a_pose_relative_to_something_without_a_pose_is_noted():
    poses, notes = converted(pose("handle", "0.1 0 0", reference="fridge"))
    assert poses == {}
    assert notes == ["1 pose not used, relative to something without a pose: handle"]


@pytest.mark.parametrize(("xyz", "xyzw"), [("1 2", "0 0 0 1"), ("1 2 3", "0 0 0 2"), ("a b c", "0 0 0 1")])
def test_a_pose_that_is_not_valid_is_noted(xyz, xyzw):
    poses, notes = converted(pose("cup", xyz, xyzw) + pose("table", "1 2 3"))
    assert poses.keys() == {"table"}
    assert notes == ["1 pose not used, not three numbers and a unit quaternion: cup"]


def test_poses_in_a_cycle_are_rejected():
    turtle = "".join(pose(a, "0 0 1", reference=b) for a, b in ("ab", "bc", "ca"))
    with pytest.raises(
        errors.BadFile, match=r"^poses are relative to each other: a to b to c to a; state one of them in"
    ):
        converted(turtle)


def test_a_document_in_the_map_frame_stays_as_it_is():
    triples = rdf.parse((HEAD + pose("fridge", "1 2 3")).encode(), "f")
    assert map_frame.express_in_map_frame(triples, SOMA) == (triples, [])
    assert map_frame.express_in_map_frame(triples, []) == (triples, [])


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0.0, 0.8)])
@pytest.mark.parametrize("angle", [0.0, 0.1, 1.5, math.pi, -2.0])
def test_a_rotation_matrix_becomes_its_quaternion(axis, angle):
    w, (x, y, z) = math.cos(angle / 2), (math.sin(angle / 2) * part for part in axis)
    rows = [
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    ]
    found = aligned_values.quaternion_of(rows)
    assert abs(sum(a * b for a, b in zip(found, (w, x, y, z), strict=True))) == pytest.approx(1.0)


def test_a_long_chain_is_followed_once(monkeypatch):
    count = 300
    text = pose("c0", "1 0 0", reference="map") + "".join(
        pose(f"c{i}", "1 0 0", reference=f"c{i - 1}") for i in range(1, count)
    )
    calls = []
    compose = map_frame.entities.compose
    monkeypatch.setattr(map_frame.entities, "compose", lambda a, b: calls.append(1) or compose(a, b))
    poses, _ = converted(text)
    assert poses[f"c{count - 1}"][0] == count
    assert len(calls) == count
