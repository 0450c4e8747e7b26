"""Changes fact by fact, each compared with the rule table."""

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS, TYPE, is_literal
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.test_worlds import promised
from tests.kb_node.reasoner.worlds import Change


def check_in_any_order(tbox, facts):
    """Insert facts one by one, and delete them in the same order. Return the number of rejections.

    After each change exactly the conclusions of the rules hold, the changed individuals are reported, and a
    contradiction is rejected. This is done forwards and backwards, which has the same states.
    """
    schema, rejected = Closure(tbox), 0
    closures = dict[frozenset[tuple[str, str, str]], Closure]()

    def closed(some):
        key = frozenset(some)
        if key not in closures:
            closures[key] = Closure(some, base=schema)
        return closures[key]

    names = {term for s, _, o in facts for term in (s, o) if not is_literal(term)}
    for order in (facts, facts[::-1]):
        reasoner, asserted = Reasoner(tbox), list[tuple[str, str, str]]()
        changes = [Change([], [fact]) for fact in order] + [Change([fact], []) for fact in order]
        for change in changes:
            after = [fact for fact in asserted if fact not in change.delete] + change.insert
            closure, before = closed(after), _kinds(reasoner, names)
            try:
                touched = reasoner.apply(delete=change.delete, insert=change.insert).touched
            except Inconsistent as refusal:
                rejected += 1
                assert closure.clash is not None, change
                proofs.check(refusal.explanation, [*tbox, *after])
                closure = closed(asserted)
                assert _kinds(reasoner, names) == before
            else:
                assert closure.clash is None, change
                assert {s for s, _, _ in {*asserted} ^ {*after}} <= touched, change
                asserted = after
                assert _changed(before, _kinds(reasoner, names)) <= touched, change
            assert set(reasoner.inferred()) == promised(closure, [*tbox, *asserted]), change
            assert len(reasoner) == len(tbox) + len(asserted)
        assert reasoner.is_compiled
    return rejected


def check_computed(tbox, facts):
    """Assert classes and equalities, and compute edges. Suppress and restore the former, remove the latter.

    After each change exactly the conclusions of the rules hold, and the individuals whose classes or equals
    changed are reported. A contradiction is rejected. Return the number of rejections.
    """
    asserted = [fact for fact in facts if fact[1] in (TYPE, SAME_AS, DIFFERENT_FROM)]
    computed = [fact for fact in facts if fact not in asserted]
    schema, reasoner = Closure(tbox), Reasoner(tbox)
    names = {term for s, _, o in facts for term in (s, o) if not is_literal(term)}
    given, rejected = dict[tuple[str, str, str], bool](), 0
    for kind, some in (
        ("restore", asserted),
        ("add", computed),
        ("suppress", asserted),
        ("restore", asserted),
    ):
        for fact in some:
            after = {one: is_said for one, is_said in given.items() if one != fact}
            if kind != "suppress":
                after[fact] = kind == "restore"
            closure, before = Closure(after, base=schema), _kinds(reasoner, names)
            try:
                if kind == "restore" and not reasoner.has_suppressed:
                    change = reasoner.apply(insert=[fact])
                else:
                    change = reasoner.update_computed(**{kind: [fact]})
            except Inconsistent:
                rejected += 1
                assert closure.clash is not None, (kind, fact)
                closure = Closure(given, base=schema)
                assert _kinds(reasoner, names) == before
            else:
                assert closure.clash is None, (kind, fact)
                given = after
                assert _changed(before, _kinds(reasoner, names)) <= change.touched, (kind, fact)
            said = [one for one, is_said in given.items() if is_said]
            assert set(reasoner.inferred()) == promised(closure, [*tbox, *said]), (kind, fact)
            assert set(reasoner.computed()) == set(given) - set(said)
    reasoner.update_computed(remove=computed)
    reasoner.apply(delete=asserted)
    assert set(reasoner.inferred()) == promised(schema, tbox)
    assert reasoner.is_compiled
    return rejected


def _changed(before, after):
    return {name for name, kind in after.items() if before[name] != kind}


def _kinds(reasoner, names):
    """Return the classes and the equals of each individual."""
    return {name: (reasoner.types(name), frozenset(reasoner.equals(name))) for name in names}
