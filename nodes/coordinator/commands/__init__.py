"""The command handlers: each turns a command into a transaction for the knowledge base, and replies.

`dispatcher.py` calls the handler, which `@handles(COMMAND)` registers (`registration.py`). The handlers
validate arguments and resolve names. The knowledge base checks consistency. This package does not depend on
Zenoh.

Each handler is a coroutine of requests to the knowledge base (`kb_coroutines.py`). The handlers share
`commit.py` and `map_view.py`, the coordinator's replica of the map.
"""
