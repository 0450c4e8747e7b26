"""Changes fact by fact, each compared with the rule table."""

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.test_worlds import promised, refused
from tests.kb_node.reasoner.worlds import Change


def check_in_any_order(tbox, facts):
    """Insert facts one by one, and delete them in the same order. Return the number of rejections.

    After each change exactly the conclusions of the rules hold, and a contradiction is rejected. This is
    done from several facts on, forwards and backwards.
    """
    schema, rejected = Closure(tbox), 0
    for order in (facts, facts[::-1], facts[len(facts) // 2 :] + facts[: len(facts) // 2]):
        reasoner, asserted = Reasoner(tbox), list[tuple[str, str, str]]()
        changes = [Change([], [fact]) for fact in order] + [Change([fact], []) for fact in order]
        for change in changes:
            after = [fact for fact in asserted if fact not in change.delete] + change.insert
            closure = Closure(after, base=schema)
            refusal = refused(reasoner, change)
            assert (refusal is None) == (closure.clash is None), change
            if refusal is not None:
                rejected += 1
                proofs.check(refusal, [*tbox, *after])
                closure = Closure(asserted, base=schema)
            else:
                asserted = after
            assert set(reasoner.inferred()) == promised(closure, [*tbox, *asserted]), change
        assert reasoner.is_compiled
    return rejected
