"""Requests as they are: each `.json` beside this file can be posted as it is.

`index.json` says of each where it is posted, and what its two objectives are. All were written
by `python -m service.examples`, and are written alike whenever it runs again.
"""
