from nodes.sim_node.models.library import build as library_model
from nodes.sim_node.orders import moves, newcomers
from schemas.scenes import Placement
from tests.sim_node.orders import hand, order, pose


def test_each_order_is_accepted_or_has_a_reason():
    accepted, failed = newcomers(
        [
            order("cup1", "cup", pose(1, 2), commit=7),
            order("cup1", "cup", pose(3, 0)),
            order("table1", "table", pose(0, 0)),
            order("far", "cup", pose(9000, 0)),
            order("huge", "cup", pose(2, 0), size_m=(1000.0, 1.0, 1.0)),
        ],
        library_model,
        taken=lambda name: name == "table1",
    )
    record, model = accepted.pop("cup1")
    assert accepted == {}
    assert (record.ordered, record.commit, record.shape_commit) == (pose(1, 2), 7, 7)
    assert (record.size_m, record.model) == (model.size_m, model.name)
    assert set(failed) == {"cup1", "table1", "far", "huge"}
    assert "twice" in failed["cup1"]
    assert "already" in failed["table1"]
    assert "9000 m from the origin" in failed["far"]
    assert "1000 m" in failed["huge"]


def test_with_commit_0_a_body_is_the_worlds_own():
    accepted, _ = newcomers([order("cup1", "cup", pose(0, 0), commit=0)], library_model, lambda _: False)
    assert not accepted["cup1"][0].entity


def test_what_cannot_be_moved_has_a_reason():
    first, last = hand("cup1", pose(1, 0)), Placement(name="cup1", pose=pose(2, 0), commit=3)
    ordered = [order(name, "cup", pose(0, 0)) for name in ("cup1", "can1")]
    made, _ = newcomers(ordered, library_model, taken=lambda name: False)
    there = {name: record for name, (record, _) in made.items()}
    accepted, failed = moves([first, hand("x", pose(0, 0)), hand("can1", pose(0, 2000)), last], there)
    assert accepted == [first, last]
    assert "no body named x" in failed["x"]
    assert "too far" in failed["can1"]
