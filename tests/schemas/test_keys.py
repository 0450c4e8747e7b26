from semmap.schemas import keys


def test_every_key_is_below_the_root():
    for key in (keys.CMD, keys.BRIDGE, keys.SIM, keys.live_key("kb_node"), *(t.key for t in keys.TOPICS)):
        assert key.startswith(f"{keys.ROOT}/")


def test_no_topic_is_served_as_a_query():
    for topic in keys.TOPICS:
        assert not topic.key.startswith((f"{keys.CMD}/", f"{keys.BRIDGE}/"))


def test_made_keys_match_their_topics():
    assert keys.entity_key("Chair", "chair1") == keys.ENTITY.key.replace("*/*", "Chair/chair1")
    assert keys.health_key("kb_node") == keys.HEALTH.key.replace("*", "kb_node")


def test_liveliness_is_out_of_reach_of_double_stars():
    assert keys.live_key("kb_node", "17") == "semmap/@live/kb_node/17"


def test_last_chunk():
    assert keys.last_chunk("robot1/semmap/cmd/add") == "add"
    assert keys.last_chunk("add") == "add"


def test_the_key_of_a_command_contains_the_identity():
    key = f"{keys.commands_as('bob')}/add"
    assert key == "semmap/as/bob/cmd/add"
    assert keys.asked_as(key) == "bob"
    assert keys.last_chunk(key) == "add"
    assert keys.asked_as(f"{keys.commands_as()}/add") == "*"
    for another in (
        f"{keys.CMD}/add",
        f"{keys.BRIDGE}/commit",
        "semmap",
        "semmap/as",
        "x/as/bob/cmd/add",
        "",
    ):
        assert keys.asked_as(another) == ""


def test_the_server_of_a_command_does_not_depend_on_the_identity():
    for verb in ("add", "sparql"):
        assert keys.servers(keys.commands_as("bob"), verb) == keys.servers(keys.CMD, verb)
    assert keys.servers(keys.CMD, "sparql") == ("kb_node", "coordinator")
    assert keys.served(keys.BRIDGE) == keys.BRIDGE
