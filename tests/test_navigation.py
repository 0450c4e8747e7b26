"""Floor plans, ways and loaded plans, through a whole system with its walls."""

import json

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

from semmap.schemas import errors


@pytest.fixture(scope="module")
def system(flat_scene):
    return flat_scene


def test_a_plan_to_files_and_back_as_rooms(system, tmp_path):
    plan = tmp_path / "bare.png"
    system.cli("floorplan", plan, "--no-furniture")
    pixels = np.asarray(Image.open(plan))
    assert set(np.unique(pixels)) == {0, 205, 254}
    told = system.cli("load", tmp_path / "bare.yaml", "--dry-run")
    lines = [line for line in told.splitlines() if line.startswith(("  room", "  doorway"))]
    assert len([line for line in lines if line.startswith("  room")]) == 6
    assert "  doorway1: 0.9 m wide at (6, 1.8), from room1 to room2" in lines
    assert " room1 " not in system.cli("list", "--class", "Room")
    missing = tmp_path / "missing.yaml"
    missing.write_text("image: nothing.pgm\nresolution: 0.05\n")
    assert "the image of missing.yaml is missing" in system.cli("load", missing, status=2)


@pytest.mark.parametrize("turn_deg", [0, 20, 45, 60])
def test_furniture_makes_no_rooms_however_the_plan_is_turned(system, tmp_path, turn_deg):
    plan = tmp_path / "full.png"
    system.cli("floorplan", plan)
    pixels = np.asarray(Image.open(plan))
    turned = ndimage.rotate(pixels, turn_deg, order=0, cval=205)  # grey is unknown
    Image.fromarray(turned).save(plan)
    told = system.cli("load", tmp_path / "full.yaml", "--dry-run").splitlines()
    assert len([line for line in told if line.startswith("  room")]) == 6
    widths = [float(line.split()[1]) for line in told if line.startswith("  doorway") and " wide at" in line]
    assert widths == pytest.approx([0.9] * 6, abs=0.06)


def test_plans_of_other_kinds(system, tmp_path):
    system.cli("floorplan", tmp_path / "flat.svg")
    assert "kitchen" in (tmp_path / "flat.svg").read_text()
    system.cli("floorplan", tmp_path / "flat.geojson", "--as-of", 1)
    features = json.loads((tmp_path / "flat.geojson").read_text())["features"]
    assert {f["properties"]["kind"] for f in features} == {"place", "door", "thing", "wall"}
    assert "unknown floor plan format" in system.cli("floorplan", tmp_path / "flat.bmp", status=2)
    assert "LOW must be less than HIGH" in system.cli(
        "floorplan", plan := tmp_path / "x.png", "--height-range", 2, 1, status=2
    )
    assert not plan.exists()


def test_ways_in_words_in_python_and_when_a_door_is_shut(system):
    told = system.cli("route", "bathroom", "studio")
    assert "bathroom1 to corridor1 to studio1, through door4 and door6" in told
    with system.client() as client:
        way = client.route("bathroom1", (8.0, 6.0))
        assert (way.places, way.doors) == (("bathroom1", "corridor1", "studio1"), ("door4", "door6"))
        assert 8.0 < way.metres < 12.0
        shut = client.set("door4", "isOpen", False).commit
        assert client.route("bathroom1", "studio1").closed == ("door4",)
        assert client.route("bathroom1", "studio1", as_of=1).closed == ()
        with pytest.raises(errors.Refused, match="it is outside every place of the map"):
            client.route("bathroom1", (50.0, 50.0))
        with pytest.raises(errors.UnknownName, match="no entity has the name, label or class 'atlantis'"):
            client.route("bathroom1", "atlantis")
        client.undo(shut)
