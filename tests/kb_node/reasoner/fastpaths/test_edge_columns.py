"""Edges in columns, and the nodes at their ends."""

from semmap.nodes.kb_node.reasoner.fastpaths.edge_columns import Column, Ends, ends_of
from semmap.nodes.kb_node.reasoner.tbox.axioms import Group

P, Q = 5, 6
TRIPLES = [("<a>", "<p>", "<b>"), ("<b>", "<p>", "<c>")]
COLUMN = Column(P, 0, [1, 2], [2, 3], TRIPLES)


def test_a_column_has_the_edges_at_some_places():
    assert COLUMN.at([1]) == Column(P, 0, [2], [3], TRIPLES[1:])
    assert COLUMN.at([1, 0]) == Column(P, 0, [2, 1], [3, 2], TRIPLES[::-1])
    assert ends_of([COLUMN, Column(Q, 0, [9], [1])]) == {1, 2, 3, 9}


def test_the_nodes_along_a_group_are_the_ends_of_its_edges():
    before = Ends({P: {7}}, {Q: {8}})
    ends = before.with_columns([COLUMN, Column(Q, 0, [4], [1])])
    assert ends == ({P: {1, 2, 7}, Q: {4}}, {P: {2, 3}, Q: {1, 8}})
    assert before == ({P: {7}}, {Q: {8}})
    assert ends.along(Group((P,), ())) == {1, 2, 7}
    assert ends.along(Group((), (P,))) == {2, 3}
    assert ends.along(Group((Q,), (P, Q))) == {1, 2, 3, 4, 8}
