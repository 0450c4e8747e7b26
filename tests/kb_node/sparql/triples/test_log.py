"""Each forked process reads the commits of the log once."""

import os

from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.nodes.kb_node.sparql.triples.log import Log
from semmap.ontology import vocabulary as v


def delta(seq):
    return Delta(seq=seq, inserted=((v.entity_iri(f"c{seq}"), v.RDF_TYPE, v.dm("Chair")),) * seq)


def test_a_child_reads_from_its_fork_on():
    log = Log()
    log.append(delta(1))
    inbox, outbox = os.pipe()
    proceed, go = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.read(proceed, 1)
            after = list(log.read_new())
            sound = after == [delta(2), delta(300)] and list(log.read_new()) == []
            os.write(outbox, b"1" if sound else b"0")
        finally:
            os._exit(0)
    log.append(delta(2))
    log.append(delta(300))
    os.write(go, b".")
    assert os.read(inbox, 1) == b"1"
    os.waitpid(child, 0)
    assert log.size == 303
    log.close()
    for fd in (inbox, outbox, proceed, go):
        os.close(fd)


def test_an_incomplete_entry_is_read_later():
    log, half = Log(), Log()
    log.append(delta(1))
    whole = os.pread(log.fileno(), 10_000, 0)
    for end in range(len(whole)):
        os.pwrite(half.fileno(), whole[:end], 0)
        assert list(half.read_new()) == []
    os.pwrite(half.fileno(), whole, 0)
    assert list(half.read_new()) == [delta(1)]
    log.close()
    half.close()
