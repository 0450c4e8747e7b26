"""`semmap perceive`, which needs no system."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from semmap.nodes.extern.cli.app import execute
from semmap.nodes.perception_node.fitting import fit
from semmap.nodes.perception_node.views.segments import map_points
from tests.perception_node.detection.models import write_model, yolov8
from tests.perception_node.files.made import header
from tests.perception_node.segmentation.scenes import boxes_on_table
from tests.perception_node.segmentation.test_patches import SCENES

SEEN = boxes_on_table(*SCENES["apart"])


def write_cloud(file, *, organised=True):
    points = SEEN.cloud.points_camera
    height, width = points.shape[:2] if organised else (1, points.size // 3)
    head = header("binary", fields="x y z", width=width, height=height)
    file.write_bytes(head + points.astype(np.float32).tobytes())
    return str(file)


@pytest.mark.parametrize("organised", [True, False])
def test_labels_have_the_shape_of_the_cloud(tmp_path, capsys, organised):
    cloud = write_cloud(tmp_path / "boxes.pcd", organised=organised)
    assert execute(["perceive", cloud, "--labels", str(tmp_path / "labels.npy")]) == 0
    labels = np.load(tmp_path / "labels.npy")
    assert np.issubdtype(labels.dtype, np.integer)
    assert labels.shape == ((480, 640) if organised else (1, 480 * 640))
    assert labels.max() == 2
    for box in (1, 2):
        assert np.bincount(SEEN.truth.ravel()[labels.ravel() == box]).argmax() > 0
    assert "2 objects" in capsys.readouterr().out


@pytest.mark.parametrize("organised", [True, False])
@pytest.mark.parametrize("posed", [True, False])
def test_a_cloud_in_the_frame_of_a_map_gives_things_there(tmp_path, capsys, organised, posed):
    seen = boxes_on_table(*SCENES["apart"], posed=True)
    points = map_points(seen.cloud, seen.cloud.map_from_camera)
    if not organised:
        points = points.reshape(-1, 3)
        points = np.random.default_rng(0).permutation(points[np.isfinite(points[:, 2])])[None]
    height, width = points.shape[:2]
    head = header("binary", fields="x y z", width=width, height=height)
    (tmp_path / "map.pcd").write_bytes(head + points.astype(np.float32).tobytes())
    w, x, y, z = Rotation.from_matrix(seen.cloud.map_from_camera[:3, :3]).as_quat(scalar_first=True)
    pose = ["--pose", *map(str, (*seen.cloud.map_from_camera[:3, 3], w, x, y, z))] if posed else []
    assert execute(["perceive", str(tmp_path / "map.pcd"), "--up", "z", "--format", "json", *pose]) == 0
    (frame,) = json.loads(capsys.readouterr().out)
    assert frame["frame"] == "map"
    places = [
        thing["observation"]["pose"]["position_m"] for thing in frame["objects"] if thing["observation"]
    ]
    for x, y in ((-0.15, -0.05), (0.15, -0.05)):
        assert any(place == pytest.approx((x, y, 0.0), abs=0.035) for place in places)
    assert execute(["perceive", str(tmp_path / "map.pcd"), "--up", "z", "--pose", *"0002000"]) == 2
    assert "unit quaternion" in capsys.readouterr().err


def test_json_is_for_programs(tmp_path, capsys):
    cloud = write_cloud(tmp_path / "boxes.pcd")
    assert execute(["perceive", cloud, "--format", "json", "--labels", str(tmp_path / "labels.npy")]) == 0
    (frame,) = json.loads(capsys.readouterr().out)
    assert (frame["file"], frame["frame"]) == (cloud, "plane")
    labels = np.load(tmp_path / "labels.npy")
    assert [thing["label"] for thing in frame["objects"]] == [1, 2]
    assert [thing["points"] for thing in frame["objects"]] == [(labels == label).sum() for label in (1, 2)]
    for thing in frame["objects"]:
        assert 0.0 < thing["observation"]["probability"] <= 1.0
        assert len(thing["observation"]["pose"]["position_m"]) == 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["missing.pcd"], "there is no file or folder missing.pcd"),
        (["x" * 300], "xx cannot be read: File name too long"),
        (["boxes.pcd", "boxes.pcd", "--labels", "labels.npy"], "a single frame"),
        (["boxes.pcd", "--labels", "labels.txt"], "labels.npy"),
        (["boxes.pcd", "--labels", "nowhere/labels.npy"], "cannot be written"),
        (["empty.pcd"], "contains no points"),
        (["table.mcap", "--every", "nan"], "--every must be a number of seconds"),
        ([], "FILE"),
    ],
)
def test_what_cannot_be_done_is_reported_in_one_line(tmp_path, capsys, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    write_cloud(tmp_path / "boxes.pcd")
    (tmp_path / "empty.pcd").write_bytes(header("binary", width=0, height=0))
    (tmp_path / "table.mcap").touch()
    assert execute(["perceive", *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def write_frame(folder):
    points = SEEN.cloud.points_camera
    height, width = points.shape[:2]
    folder.mkdir(parents=True)
    depth = np.nan_to_num(points[..., 2] * 1000).astype(np.uint16)
    Image.fromarray(depth).save(folder / "depth.png")
    Image.new("RGB", (width, height), (120, 120, 120)).save(folder / "rgb.png")
    (fx, _, cx), (_, fy, cy), _ = SEEN.cloud.intrinsics.tolist()
    (folder / "camera.json").write_text(json.dumps({"fx": fx, "fy": fy, "cx": cx, "cy": cy}))


def test_a_dataset_has_a_row_for_each_frame_and_goes_on_after_a_bad_one(tmp_path, capsys):
    for name in ("first", "third"):
        write_frame(tmp_path / "frames" / name)
    (tmp_path / "frames" / "second").mkdir()
    out, labels = tmp_path / "out.json", tmp_path / "labels"
    words = ["--frames", str(tmp_path / "frames"), "--json", str(out), "--labels", str(labels)]
    assert execute(["perceive", *words]) == 0
    rows = json.loads(out.read_text())
    assert [row["frame"] for row in rows] == ["first", "second", "third"]
    assert "lacks" in rows[1]["error"]
    assert rows[1]["objects"] == []
    assert rows[0]["objects"] == rows[2]["objects"]
    seen = np.load(labels / "first.npy")
    for n, thing in enumerate(rows[0]["objects"], 1):
        x0, y0, x1, y1 = thing["box_px"]
        ys, xs = np.nonzero(seen == n)
        assert (xs.min(), ys.min(), xs.max() + 1, ys.max() + 1) == (x0, y0, x1, y1)
        assert thing["points"] == len(xs)
    assert not (labels / "second.npy").exists()
    said = capsys.readouterr().out
    assert "3 frames" in said
    assert "1 frame skipped" in said


def test_a_dataset_without_any_frame_that_can_be_used_is_an_error(tmp_path, capsys):
    (tmp_path / "frames" / "half").mkdir(parents=True)
    out = tmp_path / "out.json"
    assert execute(["perceive", "--frames", str(tmp_path / "frames"), "--json", str(out)]) == 2
    assert "no usable frames" in capsys.readouterr().err
    assert [bool(row["error"]) for row in json.loads(out.read_text())] == [True]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["boxes.pcd", "--frames", "."], "camera.json"),
        (["boxes.pcd", "--json", "out.json"], "--frames"),
        (["--frames", "missing"], "there is no file or folder missing"),
        (["--frames", "empty"], "no folders of frames"),
    ],
)
def test_what_a_dataset_is_not_is_reported(tmp_path, capsys, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    (tmp_path / "boxes.pcd").touch()
    assert execute(["perceive", *arguments]) == 2
    assert said in capsys.readouterr().err


def test_notes_on_a_frame_are_printed_once_and_are_in_its_row(tmp_path, capsys):
    for name in ("first", "second"):
        write_frame(tmp_path / "frames" / name)
        camera = tmp_path / "frames" / name / "camera.json"
        camera.write_text(json.dumps(json.loads(camera.read_text()) | {"cx": 20.0}))
    out, first = tmp_path / "out.json", tmp_path / "frames" / "first"
    assert execute(["perceive", "--frames", str(tmp_path / "frames"), "--json", str(out)]) == 0
    doubt = "have the principal point far from the middle"
    assert [doubt in note for row in json.loads(out.read_text()) for note in row["notes"]] == [True, True]
    error = capsys.readouterr().err
    assert error.count(doubt) == 1
    assert "note: first and second: camera.json: the intrinsics" in error
    pictures = [str(first / name) for name in ("rgb.png", "depth.png")]
    assert (
        execute(["perceive", *pictures, "--intrinsics", str(first / "camera.json"), "--format", "json"]) == 0
    )
    printed = capsys.readouterr()
    assert f"note: {first / 'depth.png'}: the intrinsics" in printed.err
    assert doubt in json.loads(printed.out)[0]["notes"][0]


def test_the_robot_of_each_frame_is_left_out(tmp_path, capsys):
    for name in ("without", "with"):
        write_frame(tmp_path / "frames" / name)
    camera = tmp_path / "frames" / "with" / "camera.json"
    pose = np.diag([1.0, -1.0, -1.0, 1.0]).tolist()
    camera.write_text(json.dumps(json.loads(camera.read_text()) | {"map_from_camera": pose}))
    (tmp_path / "ball.xml").write_text(
        '<mujoco><worldbody><geom size="50" pos="0 0 -50.1"/></worldbody></mujoco>'
    )
    (camera.parent / "robot.json").write_text('{"model": "../../ball.xml"}')
    words = ["--json", str(tmp_path / "out.json"), "--mask-robot", "robot.json"]
    assert execute(["perceive", "--frames", str(tmp_path / "frames"), *words]) == 0
    with_robot, without = json.loads((tmp_path / "out.json").read_text())
    assert (with_robot["objects"], with_robot["error"]) == ([], "")
    assert "robot.json cannot be read" in without["error"]


def test_masks_segment_a_frame_and_an_unknown_label_is_reported(tmp_path, capsys):
    write_frame(tmp_path / "frames" / "first")
    (height, width), box = SEEN.truth.shape, np.isin(SEEN.truth, [1])
    np.save(tmp_path / "frames" / "first" / "mine.npy", box.astype(np.uint16))
    out = tmp_path / "out.json"
    words = ["perceive", "--frames", str(tmp_path / "frames"), "--json", str(out), "--masks-only", "--masks"]
    assert execute([*words, "mine.npy"]) == 0
    ((found,),) = [row["objects"] for row in json.loads(out.read_text())]
    ys, xs = np.nonzero(box)
    assert found["box_px"] == pytest.approx([xs.min(), ys.min(), xs.max() + 1, ys.max() + 1], abs=6)
    counts = [0, *np.diff(np.flatnonzero(np.diff(np.r_[-1, box.T.ravel().astype(int), -1]))).tolist()]
    counts = counts[1:] if not box[0, 0] else counts
    told = [{"segmentation": {"size": [height, width], "counts": counts}, "category": "spork", "score": 0.9}]
    (tmp_path / "frames" / "first" / "yolo.json").write_text(json.dumps(told))
    capsys.readouterr()
    assert execute([*words, "yolo.json"]) == 0
    assert (
        "mask labels without a class: spork; map them to classes with --label-map FILE"
        in capsys.readouterr().err
    )
    (tmp_path / "map.json").write_text('{"spork": "Box"}')
    assert execute([*words, "yolo.json", "--label-map", str(tmp_path / "map.json")]) == 0
    ((found,),) = [row["objects"] for row in json.loads(out.read_text())]
    assert found["class"] == "Box"
    (tmp_path / "map.json").write_text('{"spork": "Boxx"}')  # of an ontology of one's own, or misspelt
    capsys.readouterr()
    assert execute([*words, "yolo.json", "--label-map", str(tmp_path / "map.json")]) == 0
    assert "without training data: Boxx; did you mean Box" in capsys.readouterr().err
    ((found,),) = [row["objects"] for row in json.loads(out.read_text())]
    assert (found["class"], found["probability"]) == ("Boxx", 0.9)


def test_a_model_of_a_detector_labels_the_segment_in_its_box(tmp_path, capsys):
    pytest.importorskip("onnxruntime")
    write_frame(tmp_path / "frames" / "first")
    (height, width), (rows, columns) = SEEN.truth.shape, np.nonzero(SEEN.truth == 1)
    ratio = min(640 / height, 640 / width)
    top, left = (640 - round(height * ratio)) // 2, (640 - round(width * ratio)) // 2
    low, high = (
        (xs.min() * ratio + pad, (xs.max() + 1) * ratio + pad) for xs, pad in ((columns, left), (rows, top))
    )
    box = (sum(low) / 2, sum(high) / 2, low[1] - low[0], high[1] - high[0])
    model = write_model(
        tmp_path / "m.onnx", {"output0": yolov8([(*box, 0, 0.9)], classes=1)}, metadata={"names": "['spork']"}
    )
    out = tmp_path / "out.json"
    words = ["perceive", "--frames", str(tmp_path / "frames"), "--json", str(out), "--detector", str(model)]
    assert execute(words) == 0
    error = capsys.readouterr().err
    assert "note: m.onnx: layout yolov8, 1 class name\n" in error
    assert "mask labels without a class: spork" in error
    (row,) = json.loads(out.read_text())
    (found,) = [one for one in row["objects"] if one["label"] == "spork"]
    assert found["box_px"] == pytest.approx(
        [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1], abs=6
    )
    pictures = [str(tmp_path / "frames" / "first" / name) for name in ("rgb.png", "depth.png")]
    camera = str(tmp_path / "frames" / "first" / "camera.json")
    more = ["--intrinsics", camera, "--detector", str(model), "--masks-only", "--format", "json"]
    assert execute(["perceive", *pictures, *more]) == 0
    ((found,),) = [one["objects"] for one in json.loads(capsys.readouterr().out)]
    assert found["label"] == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["boxes.pcd", "--label-map", "map.json"], "require --masks"),
        (["boxes.pcd", "--masks-only"], "require --masks or --detector"),
        (
            ["boxes.pcd", "--masks", "a.png", "--detector", "m.onnx"],
            "--masks and --detector exclude each other",
        ),
        (["boxes.pcd", "--detector-names", "coco"], "--detector-names requires --detector MODEL.onnx"),
        (["boxes.pcd", "--detector", "absent.onnx"], "there is no file or folder absent.onnx"),
        (["boxes.pcd", "--masks", "missing.npy"], "missing.npy cannot be read"),
        (["boxes.pcd", "--masks", "small.npy"], "this one has 4 x 3 of int64"),
        (["boxes.pcd", "--masks", "small.npy", "--label-map", "small.npy"], "not a JSON object of labels"),
    ],
)
def test_what_is_wrong_with_masks_is_reported_in_one_line(tmp_path, capsys, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    write_cloud(tmp_path / "boxes.pcd")
    np.save(tmp_path / "small.npy", np.zeros((3, 4), int))
    for name in ("map.json", "m.onnx"):
        (tmp_path / name).touch()
    assert execute(["perceive", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_without_open3d_models_are_not_fitted(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(fit, "find_spec", lambda module: None)
    assert execute(["perceive", write_cloud(tmp_path / "boxes.pcd"), "--fit"]) == 2
    error = capsys.readouterr().err
    assert "--fit requires Open3D" in error
    assert error.count("\n") == 1


@pytest.mark.skipif(not fit.available(), reason="Open3D is not installed")
def test_models_are_fitted_where_it_is_asked_for(tmp_path, capsys):
    cloud = write_cloud(tmp_path / "boxes.pcd")
    write_frame(tmp_path / "frames" / "one")
    assert execute(["perceive", cloud, "--fit", "--format", "json"]) == 0
    (frame,) = json.loads(capsys.readouterr().out)
    dataset = ["perceive", "--frames", str(tmp_path / "frames"), "--json", str(tmp_path / "rows.json")]
    assert execute([*dataset, "--fit"]) == 0
    (row,) = json.loads((tmp_path / "rows.json").read_text())
    seen = [*(thing["observation"] for thing in frame["objects"]), *row["objects"]]
    assert len(seen) > 2
    for thing in seen:
        score = thing.get("fit")
        assert score is None or 0.0 <= score <= 1.0
        assert np.linalg.norm(thing["pose"]["orientation_wxyz"]) == pytest.approx(1.0)
