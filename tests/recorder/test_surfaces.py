from nodes.recorder.surfaces import SurfaceShelf
from tests.recorder.messages import body, surface

SURFACE = surface()


def test_each_model_at_each_size_is_asked_for_once():
    shelf = SurfaceShelf()
    chairs = [body(f"chair{i}", model="chair") for i in range(3)]
    wanted = shelf.wanted(chairs)
    assert list(wanted) == ["chair0"]
    assert shelf.wanted(chairs) == {}
    assert shelf.of(chairs[1]) is None
    shelf.take(wanted["chair0"], SURFACE)
    assert shelf.of(chairs[2]) is SURFACE
    assert shelf.of(None) is None
