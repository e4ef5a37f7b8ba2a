"""Example requests, which can be posted as they are, and what the page draws around them.

`index.json` names the path and the two objectives of each, and what the page draws around its
stops. `python -m tests.examples` wrote the others, and writes the same again; those of Helsinki
only with a routing engine. They contain information of OpenStreetMap, (c) OpenStreetMap
contributors, which is made available under the Open Database License (ODbL).
"""
