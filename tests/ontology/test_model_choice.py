"""Selection of an entity's model by name and size."""

import msgspec
import pytest

from semmap.ontology import model_choice, model_shapes
from semmap.ontology.model_choice import chosen, require_model
from semmap.ontology.model_shapes import ModelShape, add_own, own_size_m, shapes, varieties_of
from semmap.schemas import errors


@pytest.mark.parametrize(
    ("model", "name", "wanted"),
    [
        ("bottle", "bottle1", "bottle"),
        ("bottle", "spray_bottle1", "spray_bottle"),
        ("bottle", "kitchenSprayBottle", "spray_bottle"),
        ("bottle", "wine_bottle2", "wine_bottle"),
        ("bottle", "shampoo", "flat_bottle"),
        ("glass", "wineglass3", "wine_glass"),
        ("glass", "WineGlass3", "wine_glass"),
        ("glass", "glass_of_wine", "wine_glass"),
        ("cup", "tumbler-2", "tumbler"),
        ("kettle", "teapot", "teapot"),
        ("pan", "skillet.old", "skillet"),
        ("book", "standing_book1", "standing_book"),
        ("book", "standing", "book"),
        ("cardboard_box", "box1", "cardboard_box"),
        ("cardboard_box", "upright_carton4", "upright_carton"),
        ("cardboard_box", "carton4", "small_carton"),
        ("carton", "carton1", "carton"),
        ("carton", "flat_carton1", "flat_carton"),
        ("chair", "spray_bottle1", "chair"),
        ("", "spray_bottle1", ""),
        ("can", "scanner1", "can"),
    ],
)
def test_a_name_says_the_model_in_whole_words(model, name, wanted):
    assert chosen(model, name, None) == wanted


@pytest.mark.parametrize(
    ("model", "size_m", "wanted"),
    [
        ("cardboard_box", (0.30, 0.40, 0.30), "cardboard_box"),
        ("cardboard_box", (0.40, 0.30, 0.30), "cardboard_box"),
        ("cardboard_box", (0.20, 0.20, 0.20), "small_carton"),
        ("cardboard_box", (0.20, 0.12, 0.10), "small_carton"),
        ("cardboard_box", (0.22, 0.30, 0.06), "flat_carton"),
        ("box", (0.08, 0.05, 0.15), "upright_carton"),
        ("can", (0.066, 0.066, 0.12), "can"),
        ("can", (0.09, 0.09, 0.035), "flat_can"),
        ("can", (0.105, 0.105, 0.14), "wide_can"),
        ("cup", (0.08, 0.11, 0.095), "cup"),
        ("cup", (0.11, 0.08, 0.095), "cup"),
        ("cup", (0.055, 0.075, 0.05), "espresso_cup"),
        ("cup", (0.085, 0.085, 0.11), "tumbler"),
        ("glass", (0.08, 0.08, 0.21), "wine_glass"),
        ("plate", (0.18, 0.18, 0.02), "side_plate"),
        ("plate", (0.27, 0.27, 0.03), "plate"),
        ("ball", (0.04, 0.04, 0.04), "table_tennis_ball"),
        ("ball", (0.065, 0.065, 0.065), "tennis_ball"),
        ("ball", (0.22, 0.22, 0.22), "ball"),
        ("book", (0.22, 0.16, 0.03), "book"),
        ("book", (0.15, 0.03, 0.21), "standing_book"),
        ("book", (0.03, 0.15, 0.21), "standing_book"),
        ("bottle", (0.095, 0.080, 0.25), "bottle"),
        ("bottle", (0.045, 0.09, 0.21), "flat_bottle"),
        ("lamp", (0.4, 0.4, 1.5), "floor_lamp"),
    ],
)
def test_a_size_says_the_model_that_is_nearest_to_it(model, size_m, wanted):
    assert chosen(model, "it", size_m) == wanted


def test_a_name_says_more_than_a_size_which_says_it_among_those_of_the_name():
    assert chosen("bottle", "spray_bottle1", (0.08, 0.08, 0.28)) == "spray_bottle"
    assert chosen("cardboard_box", "carton4", (0.3, 0.4, 0.1)) == "flat_carton"
    assert chosen("cardboard_box", "carton4", (0.3, 0.4, 0.3)) == "small_carton"


def test_every_model_is_the_nearest_to_its_own_size_unless_its_name_must_say_it():
    for name, shape in shapes().items():
        for model in shape.of:
            if not shape.only_named:
                assert chosen(model, "it", shape.size_m) == name
            assert chosen(model, f"{name}1", None) in (name, model)
        assert chosen(name, "it", shape.size_m) == name
        assert chosen(name, f"{name}1", None) == name


def test_varieties_are_of_models_that_there_are_and_come_without_varieties_of_their_own():
    for name, shape in shapes().items():
        assert shapes().keys() >= set(shape.of)
        assert not (shape.of and varieties_of(name) and name not in ("cereals",))
        assert own_size_m(name) is not None


@pytest.mark.parametrize(
    ("text", "said"),
    [("spary_bottle", "did you mean .*spray_bottle"), ("", "unknown model ''"), ("xyzzy", "as chair.glb")],
)
def test_a_model_that_there_is_not_is_refused(text, said):
    with pytest.raises(errors.BadRequest, match=said):
        require_model(text)


@pytest.mark.parametrize("text", ["teapot", "chair", "sofa.obj", "/home/me/sofa.glb"])
def test_a_model_of_the_library_or_a_file_is_taken(text):
    require_model(text)


@pytest.fixture
def own_models(tmp_path, monkeypatch):
    """Takes up models of a user's own, for one test."""
    known = dict(shapes())
    for module in (model_shapes, model_choice):
        monkeypatch.setattr(module, "shapes", lambda: known)
    monkeypatch.setattr(model_shapes, "_own", {})

    def take(*names):
        path = tmp_path / "model_shapes.json"
        path.write_bytes(msgspec.json.encode({name: ModelShape(size_m=(0.1, 0.1, 0.1)) for name in names}))
        forget()
        add_own(path)

    yield take
    forget()


def forget():
    caches = ("_said_by", "_told_by_size", "_logarithms")
    for cached in (model_shapes._varieties, *(getattr(model_choice, name) for name in caches)):
        cached.cache_clear()


def test_a_user_s_own_model_stands_for_all_that_the_library_s_did(own_models):
    own_models("bottle")
    assert chosen("bottle", "spray_bottle1", None) == "bottle"
    assert chosen("bottle", "it", (0.045, 0.09, 0.21)) == "bottle"
    assert chosen("can", "tuna1", None) == "flat_can"


def test_a_user_s_own_variety_is_chosen_as_the_library_s_was(own_models):
    own_models("bottle", "spray_bottle")
    assert chosen("bottle", "spray1", None) == "spray_bottle"
    assert chosen("bottle", "shampoo1", None) == "bottle"
