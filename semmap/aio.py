"""The client for programs with an event loop: the same methods as coroutines.

import semmap.aio

async with semmap.aio.connect() as client:
await client.add("Cup", "cup1", at=(1.0, 2.0, 0.75))
async with client.commits() as commits:
async for commit in commits:
print(commit.seq, commit.reason)
"""

from semmap.nodes.extern.async_client import AsyncClient, AsyncStandingQuery, connect

__all__ = ["AsyncClient", "AsyncStandingQuery", "connect"]
