"""The page: the map in a browser, to look at and to work on.

`live.py` follows the map, the poses and the health of the nodes; `page.py` is one open tab and what it shows;
`layout.py` and `panels/` draw it, `scene/` the part in three dimensions. `access.py` lets in who may come in,
and `server.py` runs it all in one process.
"""
