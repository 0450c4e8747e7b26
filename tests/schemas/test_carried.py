from semmap.schemas import wording


def test_what_was_to_be_left_is_not_said_to_be_nowhere():
    assert wording.carried("bowl1", []) == "nothing stands on bowl1 or is inside it"
    assert wording.carried("bowl1", [], ["apple1"]) == "bowl1 carried nothing along; apple1 was to be left"
    assert wording.carried("bowl1", ["apple1"]) == "bowl1 carried apple1 along"
