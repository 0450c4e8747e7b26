"""Orders wait until their body is placed."""

from __future__ import annotations

from concurrent.futures import Future

from semmap.nodes.coordinator.reconciler.waiting_orders import WaitingOrders


def done_with(result):
    future = Future()
    future.set_result(result)
    return future


def test_an_order_for_a_placed_body_is_executed_immediately():
    orders = WaitingOrders(lambda name: name == "cup1")
    assert orders.run("chair1", lambda: done_with("moved")).result(0) == "moved"


def test_orders_wait_for_their_body_and_keep_their_sequence():
    unplaced, executed = {"cup1", "plate1"}, []
    orders = WaitingOrders(unplaced.__contains__)

    def order(text):
        def execute():
            executed.append(text)
            return done_with(text)

        return execute

    futures = [orders.run(name, order(f"{name} {n}")) for n in (1, 2) for name in ("cup1", "plate1")]
    orders.release()
    assert executed == []
    unplaced.discard("cup1")
    orders.release()
    assert executed == ["cup1 1", "cup1 2"]
    assert [future.done() for future in futures] == [True, False, True, False]
    unplaced.discard("plate1")
    orders.release()
    orders.release()
    assert executed == ["cup1 1", "cup1 2", "plate1 1", "plate1 2"]
    assert [future.result(0) for future in futures] == ["cup1 1", "plate1 1", "cup1 2", "plate1 2"]
