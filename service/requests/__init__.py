"""Parse the bytes of a request into a checked Task.

`task` is the way in. `front` and `coverage` are the two kinds of request, each a pydantic model
with its JSON schema and its parser. They share `schemas` (fields), `limits`, `arrays` (matrices
and maps) and `validation` (sentences of refusals).
"""
