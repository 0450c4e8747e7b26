"""The web page, which shows the map in a browser and edits it.

- `live.py` receives the map, the poses and the health of the nodes
- `page.py` is the state of one open tab
- `layout.py` and `panels/` draw a tab, `scene/` its 3-D view, from the plain data of `views/`
- `access.py` authenticates browsers
- `server.py` runs all of it in one process
"""
