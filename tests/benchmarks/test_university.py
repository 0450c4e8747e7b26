from benchmarks.kb.university import measure


def test_what_is_measured_is_what_follows():
    found = measure(2000)
    assert found.triples == 2000
    assert found.inferred > 1000
    assert measure(2000).inferred == found.inferred
