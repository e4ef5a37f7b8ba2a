"""Parse the body of a request into a checked Task, and write and read a Task as bytes.

`parser` turns a body into a `task`, and `task_codec` turns a task into bytes and back. `front`,
`coverage`, `fleet` and `replan` have the fields of a request each, as pydantic models; they share
`fields` (types of fields), `limits`, `arrays` and `validation` (the sentences of errors).
`json_schemas` describes these requests in the OpenAPI document.
"""
