from semmap.nodes.extern.web.views.entities.deletion_effects import describe_effects, own_facts
from semmap.schemas.replies import Changed


def tried(*facts, names=("table1",), notes=()):
    return Changed(commit=None, text="x", names=names, no_longer_follows=facts, notes=notes, dry_run=True)


def test_supported_entities_and_lost_inferences_are_listed():
    said = describe_effects(
        tried(
            "table1 supports bowl1",
            "table1 type Furniture",
            "flat1 contains table1",
            notes=("on table1 was bowl1",),
        )
    )
    assert said == ("On table1 is bowl1.", "Lost inferences: flat1 contains table1.")


def test_only_the_first_of_many_facts_are_listed():
    (said,) = describe_effects(tried(*(f"flat1 contains cup{i}" for i in range(7))))
    assert said.endswith("flat1 contains cup3, and 3 more facts.")


def test_a_deletion_without_effects_has_no_text():
    assert describe_effects(tried()) == ()
    assert describe_effects(tried("table1 type Table")) == ()


def test_facts_of_deleted_entities_are_listed_separately():
    of_all = tried("table1 type Table", "flat1 contains table1", "bowl1 isOn table1")
    assert own_facts(of_all) == ("table1 type Table",)
