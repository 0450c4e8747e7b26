import math

import pytest

from semmap.nodes.kb_node.documents import urdf
from semmap.schemas import errors

BOX = '<geometry><box size="0.4 0.6 0.8"/></geometry>'


def robot(text):
    return f'<?xml version="1.0"?>\n<robot name="kitchen">\n{text}\n</robot>'.encode()


def joint(parent, child, xyz="0 0 0", rpy="0 0 0", kind="fixed"):
    return f'<joint name="{child}_joint" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/></joint>'  # noqa: E501


def test_frames_are_composed_along_the_joints():
    text = '<link name="root"/><link name="fridge"/><link name="door"/>'
    text += joint("root", "fridge", "1 2 0", f"0 0 {math.pi / 2}") + joint("fridge", "door", "0.3 0 0.5")
    links = urdf.read(robot(text), "f")
    assert links["root"].frame.position_m == (0.0, 0.0, 0.0)
    assert links["door"].frame.position_m == pytest.approx((1.0, 2.3, 0.5))
    assert links["door"].frame.yaw_rad == pytest.approx(math.pi / 2)


def test_a_long_chain_is_composed_once(monkeypatch):
    count, composed = 300, []
    compose = urdf.entities.compose
    monkeypatch.setattr(urdf.entities, "compose", lambda *of: composed.append(of) or compose(*of))
    text = "".join(f'<link name="l{n}"/>' for n in range(count + 1))
    text += "".join(joint(f"l{n}", f"l{n + 1}", "0.1 0 0") for n in range(count))
    links = urdf.read(robot(text), "f")
    assert links[f"l{count}"].frame.position_m == pytest.approx((0.1 * count, 0.0, 0.0))
    assert len(composed) == count


def test_roll_pitch_and_yaw_are_about_the_axes_of_the_parent():
    text = '<link name="a"/><link name="b"/>' + joint("a", "b", rpy="0.1 0.2 0.3")
    frame = urdf.read(robot(text), "f")["b"].frame
    assert (*frame.roll_pitch_rad, frame.yaw_rad) == pytest.approx((0.1, 0.2, 0.3))


@pytest.mark.parametrize(
    ("shapes", "middle", "size"),
    [
        (f'<collision><origin xyz="0 0 0.4"/>{BOX}</collision>', (0, 0, 0.4), (0.4, 0.6, 0.8)),
        (f"<visual>{BOX}</visual>", (0, 0, 0), (0.4, 0.6, 0.8)),
        (
            f"<visual>{BOX}</visual><collision><geometry><sphere radius='1'/></geometry></collision>",
            (0, 0, 0),
            (2, 2, 2),
        ),
        (
            "<collision><geometry><cylinder radius='0.1' length='1'/></geometry></collision>",
            (0, 0, 0),
            (0.2, 0.2, 1),
        ),
        (
            f"<collision>{BOX}</collision><collision><origin xyz='1 0 0'/>{BOX}</collision>",
            (0.5, 0, 0),
            (1.4, 0.6, 0.8),
        ),
        (
            f"<collision><origin rpy='0 0 {math.pi / 2}'/>{BOX}</collision>",
            (0, 0, 0),
            (0.6, 0.4, 0.8),
        ),
    ],
)
def test_the_box_is_around_all_shapes_of_a_link(shapes, middle, size):
    pose, extent = urdf.read(robot(f'<link name="a">{shapes}</link>'), "f")["a"].box
    assert pose.position_m == pytest.approx(middle)
    assert extent == pytest.approx(size)


def test_meshes_are_listed_and_have_no_box():
    text = '<link name="a"><visual><geometry><mesh filename="package://k/a.dae"/></geometry></visual></link>'
    link = urdf.read(robot(text), "f")["a"]
    assert (link.box, link.meshes) == (None, ("package://k/a.dae",))


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"<sdf/>", "f is not valid URDF: its root element is sdf, not robot"),
        (b"<robot", "f is not valid URDF: "),
        (robot('<link name="a"/>' + joint("a", "b")), "refers to b, which is not a link"),
        (robot('<link name="a"/><link name="b"/>' + joint("a", "b") * 2), "the link b has two parents"),
        (robot('<link name="a"/><link name="b"/>' + joint("a", "b") + joint("b", "a")), "form a cycle"),
        (robot("<link/>"), "an element lacks the attribute 'name'"),
        (robot('<link name="a"/><link name="b"/>' + joint("a", "b", "0 0")), "'0 0' is not 3 finite numbers"),
        (
            robot('<link name="a"><visual><geometry><cone/></geometry></visual></link>'),
            "unknown shape 'cone'",
        ),
        (
            robot('<link name="a"/><link name="b"/>' + joint("a", "b", "1e300 1e300 0")),
            "the link b reaches farther than 10000 m from the root",
        ),
    ],
)
def test_a_wrong_file_is_rejected_in_one_line(content, text):
    with pytest.raises(errors.BadFile) as caught:
        urdf.read(content, "f")
    assert text in caught.value.text
    assert "\n" not in caught.value.text


def test_an_unknown_encoding_is_reported():
    with pytest.raises(errors.BadFile, match="unknown encoding: nonsense"):
        urdf.read(b'<?xml version="1.0" encoding="nonsense"?><robot/>', "k.urdf")
