"""The effect of several transactions as one."""

from types import SimpleNamespace

from semmap.nodes.kb_node.reasoner.change import Change


def test_consecutive_changes_are_joined():
    runs = [SimpleNamespace(touched=frozenset({f"<{name}>"})) for name in "cd"]
    together = Change.together(
        [Change(frozenset({"<a>"}), [runs[0]]), Change(frozenset({"<a>", "<b>"}), [runs[1]])]
    )
    assert together == Change(frozenset({"<a>", "<b>"}), tuple(runs))
    assert together.touched == {"<a>", "<b>", "<c>", "<d>"}
    assert Change.together([]) == Change(frozenset(), ())
