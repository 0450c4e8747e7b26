from semmap.nodes.coordinator.scene.spawn_batches import BATCH, batches
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import BodyOrder


def order(number: int, size_m=None) -> BodyOrder:
    return BodyOrder(
        name=f"b{number}", class_="Box", pose=Pose(position_m=(0, 0, 0)), size_m=size_m, commit=1
    )


def test_few_orders_are_one_batch_as_they_come():
    orders = [order(i) for i in range(BATCH)]
    assert list(batches(orders)) == [tuple(orders)]
    assert list(batches([])) == []


def test_many_orders_are_several_batches_wide_things_first():
    orders = [order(i, (0.1, 0.1, 0.1)) for i in range(BATCH)] + [
        order(BATCH, (2.0, 1.0, 0.7)),
        order(BATCH + 1),
    ]
    first, second = batches(orders)
    assert [o.name for o in first[:2]] == [f"b{BATCH}", f"b{BATCH + 1}"]
    assert sorted(o.name for o in (*first, *second)) == sorted(o.name for o in orders)


def test_each_batch_doubles_what_is_there():
    orders = [order(i) for i in range(5 * BATCH)]
    assert [len(batch) for batch in batches(orders)] == [BATCH, BATCH, 2 * BATCH, BATCH]
