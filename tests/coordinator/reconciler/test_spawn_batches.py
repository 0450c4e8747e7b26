from semmap.nodes.coordinator.reconciler.spawn_batches import BATCH, split_orders
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import BodyOrder


def body_order(number: int, size_m=None) -> BodyOrder:
    return BodyOrder(
        name=f"b{number}", class_="Box", pose=Pose(position_m=(0, 0, 0)), size_m=size_m, commit=1
    )


def test_few_orders_are_one_batch_as_they_come():
    orders = [body_order(i) for i in range(BATCH)]
    assert list(split_orders(orders)) == [tuple(orders)]
    assert list(split_orders([])) == []


def test_many_orders_are_several_batches_wide_things_first():
    orders = [body_order(i, (0.1, 0.1, 0.1)) for i in range(BATCH)] + [
        body_order(BATCH, (2.0, 1.0, 0.7)),
        body_order(BATCH + 1),
    ]
    first, second = split_orders(orders)
    assert [o.name for o in first[:2]] == [f"b{BATCH}", f"b{BATCH + 1}"]
    assert sorted(o.name for o in (*first, *second)) == sorted(o.name for o in orders)


def test_each_batch_doubles_what_is_there():
    orders = [body_order(i) for i in range(5 * BATCH)]
    assert [len(batch) for batch in split_orders(orders)] == [BATCH, BATCH, 2 * BATCH, BATCH]
