"""Videos of the history of a map, played back."""

import av
import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.extern.movie import Film, movie
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.seed import seed
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from semmap.schemas import errors
from semmap.schemas.commits import Edit, Transaction

SMALL = Film(size=(241, 180), fps=5, longest_s=0.5)


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """The flat with four commits: a chair moves across the room, a table goes, a place is enlarged."""
    folder = tmp_path_factory.mktemp("film")
    seed(folder, HOUSEHOLD_TTL, FLAT_TTL)
    journal = Journal(folder / FILENAME)
    semantic_map = SemanticMap(journal)
    steps = (
        {"edit": (Edit(name="chair1", at=(2.0, 2.0, 0.0)),), "reason": "move chair1"},
        {"remove": ("table1",)},
        {"edit": (Edit(name="kitchen1", size=(3.0, 3.0, 2.5)),)},
    )
    for number, step in enumerate(steps):
        semantic_map.commit(Transaction(id=f"id{number}", source="operator", **step))
    journal.close()
    return folder


def pictures(file):
    with av.open(str(file)) as container:
        return [frame.to_ndarray(format="rgb24").astype(int) for frame in container.decode(video=0)]


def test_a_movie_shows_what_changes_and_is_as_long_as_it_says(data, tmp_path):
    file, told = tmp_path / "a.mp4", []
    before = (data / FILENAME).read_bytes()
    said = movie(file, SMALL, data=data, tell=told.append)
    assert said.startswith(f"wrote {file}: commits 1 to 4 in 5 s, ")
    assert told == [f"rendering scene {number} of 4" for number in (1, 2, 3, 4)]
    shown = pictures(file)
    assert {picture.shape for picture in shown} == {(180, 240, 3)}
    assert len(shown) == round(1.5 * 5) + 3 * 6
    first, last = shown[3][:160], shown[-1][:160]
    assert np.abs(first - shown[5][:160]).mean() < 2.0  # nothing happens yet
    assert np.abs(first - last).mean() > 0.3  # chair and table are elsewhere
    assert (shown[0][164:] < 90).mean() > 0.5  # the caption's ground
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]
    assert (data / FILENAME).read_bytes() == before


def test_without_opengl_rays_are_cast(data, tmp_path):
    wanted = structs.replace(SMALL, graphics=False, fps=1, since=2, until=3)
    said = movie(tmp_path / "a.mp4", wanted, data=data)
    assert said.endswith("; by ray casting, because OpenGL is not available")
    assert pictures(tmp_path / "a.mp4")[0].std() > 10.0


def test_a_place_or_a_camera_can_be_filmed(data, tmp_path):
    for number, about in enumerate(({"place": "kitchen1"}, {})):
        wanted = structs.replace(SMALL, since=3, until=4, **about)
        movie(tmp_path / f"{number}.mp4", wanted, data=data)
    kitchen, everything = (pictures(tmp_path / f"{number}.mp4")[0] for number in (0, 1))
    assert np.abs(kitchen - everything).mean() > 10.0


@pytest.mark.parametrize(
    ("wanted", "kind", "said"),
    [
        ({"speed": 0.0}, errors.BadRequest, "the speed must be greater than 0"),
        ({"longest_s": -1.0}, errors.BadRequest, "the longest wait must be 0 seconds or more"),
        ({"size": (10, 10)}, errors.BadRequest, "--size 10 10 is out of range"),
        ({"fps": 0}, errors.BadRequest, "--fps 0 is out of range"),
        ({"since": 3, "until": 2}, errors.BadRequest, "is before the beginning"),
        ({"until": 9}, errors.Refused, "there is no commit 9 yet"),
        ({"place": "kitchn1"}, errors.UnknownName, "did you mean kitchen1"),
        ({"place": "chair1"}, errors.Refused, "chair1 is not a place"),
        ({"camera": "nose"}, errors.BadRequest, "unknown camera 'nose'"),
        (
            {"camera": "nose", "place": "kitchen1"},
            errors.BadRequest,
            "--camera and --place exclude each other",
        ),
    ],
)
def test_what_cannot_be_filmed_is_said_and_leaves_nothing(data, tmp_path, wanted, kind, said):
    with pytest.raises(kind, match=said):
        movie(tmp_path / "a.mp4", structs.replace(SMALL, **wanted), data=data)
    assert not [*tmp_path.iterdir()]


def test_an_existing_file_or_another_suffix_is_rejected(data, tmp_path):
    (tmp_path / "a.mp4").write_text("mine")
    for file, said in (
        ("a.mp4", "--overwrite"),
        ("a.avi", "the suffix must be .mp4"),
        ("no/a.mp4", "there is no folder"),
    ):
        with pytest.raises(errors.SemmapError, match=said):
            movie(tmp_path / file, SMALL, data=data)
    assert (tmp_path / "a.mp4").read_text() == "mine"
    movie(tmp_path / "a.mp4", structs.replace(SMALL, since=4), data=data, overwrite=True)
    assert pictures(tmp_path / "a.mp4")
