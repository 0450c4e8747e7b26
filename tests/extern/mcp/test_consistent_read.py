from semmap.nodes.extern.mcp.consistent_read import read_at_one_commit


class Changing:
    """A map on which a commit comes at each of these steps."""

    def __init__(self, *steps):
        self.seq, self.step, self.steps = 10, 0, set(steps)

    def ask(self):
        self.step += 1
        if self.step in self.steps:
            self.seq += 1
        return self.seq


def test_a_map_that_is_still_is_read_once():
    still = Changing()
    assert read_at_one_commit(still.ask, still.ask, still.ask) == (10, 10, 10)
    assert still.step == 3


def test_it_is_read_again_where_the_map_has_changed_meanwhile():
    busy = Changing(2)
    assert read_at_one_commit(busy.ask, busy.ask, busy.ask) == (11, 11, 11)


def test_what_cannot_be_read_at_one_commit_says_so():
    busy = Changing(*range(1000))
    found, first, last = read_at_one_commit(busy.ask, busy.ask, busy.ask)
    assert first < last
    assert first <= found <= last


def test_a_map_that_was_replaced_by_an_older_one_is_that_one():
    numbers = iter((50, 3))
    assert read_at_one_commit(lambda: next(numbers), lambda: next(numbers), lambda: "x") == ("x", 3, 3)
