from semmap.schemas import wording


def test_what_was_to_be_left_is_not_said_to_be_nowhere():
    assert wording.carried("bowl1", []) == "nothing is on bowl1 or inside it"
    assert wording.carried("bowl1", [], ["apple1"]) == "nothing moved with bowl1; excluded: apple1"
    assert wording.carried("bowl1", ["apple1"]) == "apple1 moved with bowl1"
