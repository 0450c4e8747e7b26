"""Exemplars are stored in a file, listed and removed."""

from __future__ import annotations

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.perception_node.exemplar_store import ExemplarStore, known_class
from semmap.nodes.perception_node.exemplar_views import ExemplarView
from semmap.nodes.perception_node.image_features.efficientnet import FEATURES
from semmap.nodes.perception_node.pipeline import shipped
from semmap.nodes.perception_node.recognition.similarity import WIDTH
from semmap.schemas.errors import BadFile, BadRequest, Refused

VIEWS = [ExemplarView(np.linspace(0.0, n, WIDTH), (0.2 * n, 0.1, 0.3)) for n in (1, 2, 3)]


def test_what_was_shown_is_there_again(tmp_path):
    path = tmp_path / "new" / "lessons.npz"
    book = ExemplarStore(path, shipped())
    assert (book.exemplars, book.learnt) == ((), shipped())
    first = book.add("Toy", ("Object",), VIEWS, "3 frames")
    second = book.add("Cup", (), VIEWS[:1], "entity cup1")
    assert (first.number, first.class_, first.views, first.size_m) == (1, "Toy", 3, (0.4, 0.1, 0.3))
    again = ExemplarStore(path, shipped())
    assert again.exemplars == (first, second)
    for one, other in zip(again.learnt.exemplars.exemplars, book.learnt.exemplars.exemplars, strict=True):
        assert (one.views == other.views).all()
        assert (one.class_, one.ancestors, one.leaf) == (other.class_, other.ancestors, other.leaf)
    assert again.forget(1) == first
    assert ExemplarStore(path, shipped()).exemplars == (second,)
    again.forget(2)
    assert again.learnt is shipped()
    assert ExemplarStore(path, shipped()).learnt is shipped()


def test_images_are_kept_and_files_of_versions_without_them_are_read(tmp_path):
    path, image = tmp_path / "lessons.npz", np.linspace(0.0, 0.05, FEATURES)
    store = ExemplarStore(path, shipped())
    store.add("Toy", (), [*VIEWS[:1], ExemplarView(VIEWS[1].features, VIEWS[1].size_m, image)], "")
    for one in (store, ExemplarStore(path, shipped())):
        (exemplar,) = one.learnt.exemplars.exemplars
        assert not exemplar.images[0].any()
        assert exemplar.images[1] == pytest.approx(image, abs=1e-4)
    with np.load(path) as arrays:
        np.savez(path, description=arrays["description"], views=arrays["views"])
    (exemplar,) = ExemplarStore(path, shipped()).learnt.exemplars.exemplars
    assert (exemplar.images == np.zeros((2, FEATURES))).all()


def test_what_cannot_be_is_refused_and_nothing_is_kept(tmp_path):
    book = ExemplarStore(tmp_path / "lessons.npz", shipped())
    with pytest.raises(Refused, match="no exemplar with number 1; none is stored"):
        book.forget(1)
    with pytest.raises(BadRequest, match="name a more specific class"):
        book.add("Object", (), VIEWS, "")
    with pytest.raises(BadRequest, match=f"a view must have {WIDTH} features"):
        book.add("Toy", (), [*VIEWS, ExemplarView(np.zeros(7), (1.0, 1.0, 1.0))], "")
    with pytest.raises(BadRequest, match=f"a view must have {WIDTH} features"):
        book.add("Toy", (), [ExemplarView(np.full(WIDTH, np.nan), (1.0, 1.0, 1.0))], "")
    with pytest.raises(BadRequest, match="create it with the same version"):
        book.add("Toy", (), [ExemplarView(np.zeros(WIDTH), (1.0, 1.0, 1.0), np.zeros(7))], "")
    assert not list(tmp_path.iterdir())
    book.add("Toy", (), VIEWS, "")
    with pytest.raises(Refused, match="no exemplar with number 7; stored are: 1"):
        book.forget(7)


@pytest.mark.parametrize("content", [b"", b"nothing"])
def test_a_file_of_something_else_is_told(tmp_path, content):
    (tmp_path / "lessons.npz").write_bytes(content)
    with pytest.raises(BadFile, match="has no exemplars of this version"):
        ExemplarStore(tmp_path / "lessons.npz", shipped())


def test_a_file_of_another_version_is_told(tmp_path):
    path = tmp_path / "lessons.npz"
    ExemplarStore(path, shipped()).add("Toy", (), VIEWS, "")
    with np.load(path) as arrays:
        np.savez(path, description=arrays["description"], views=arrays["views"][:, 1:])
    with pytest.raises(BadFile, match="its views are of another version"):
        ExemplarStore(path, shipped())


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(BadFile, match="cannot be written"):
        ExemplarStore(tmp_path / "file" / "lessons.npz", shipped()).add("Toy", (), VIEWS, "")


def test_classes_are_found_as_people_write_them():
    ancestors = shipped().ancestors
    assert known_class("scissors", ancestors) == "Scissors"
    with pytest.raises(BadRequest, match=r"unknown class 'Scisors'; did you mean Scissors"):
        known_class("Scisors", ancestors)


def test_a_lesson_is_told_by_its_fields(tmp_path):
    told = ExemplarStore(None, shipped()).add("Toy", (), VIEWS, "here")
    assert structs.asdict(told) | {"stamp_ns": 0} == {
        "number": 1,
        "class_": "Toy",
        "views": 3,
        "size_m": (0.4, 0.1, 0.3),
        "shown": "here",
        "stamp_ns": 0,
    }
