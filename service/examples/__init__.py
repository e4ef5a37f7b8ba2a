"""Example requests: each `.json` file in this folder can be posted as it is.

`index.json` names the path and the two objectives of each. `python -m service.examples` wrote
them, and writes the same again; the one by road only with a routing engine. That one contains
information of OpenStreetMap, (c) OpenStreetMap contributors, which is made available under the Open
Database License (ODbL).
"""
