"""Remedies: changes to a refused request after which there is a plan, as JSON patches."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from paretour.expect import members, text


@dataclass(frozen=True)
class Remedy:
    """A change to a refused request that the service tried: after it, there is a plan.

    Attributes:
        code: What is changed, in a word that stays the same in all releases.
        detail: The change in a sentence.
        patch: The change as a JSON patch (RFC 6902).
        values: The values of the sentence by name.
    """

    code: str
    detail: str
    patch: Sequence[Mapping[str, Any]]
    values: Mapping[str, Any]

    def applied_to(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Return a copy of the refused request with this change.

        Args:
            request: The members of the request, as `Plan.request`.
        """
        changed = deepcopy(dict(request))
        for operation in self.patch:
            _apply(operation, changed)
        return changed


def in_words(remedies: Sequence[Remedy]) -> list[str]:
    """Return a heading and a line for each remedy; nothing if there is none."""
    if not remedies:
        return []
    heading = "Each of these changes to the request alone helps, as was tried:"
    return [heading, *(f"- {remedy.detail}" for remedy in remedies)]


def parse_remedy(value: Any, where: str) -> Remedy:
    """Return a remedy of a problem document."""
    document = members(value, where)
    return Remedy(
        code=document.read("code", text),
        detail=document.read("detail", text),
        patch=document.document.get("patch", ()),
        values=document.document.get("values", {}),
    )


def _apply(operation: Mapping[str, Any], document: Any) -> None:
    """Carry out an operation on a member of an object, the kind that remedies have."""
    *path, last = (_unescaped(part) for part in operation["path"].split("/")[1:])
    for part in path:
        document = document[int(part) if isinstance(document, Sequence) else part]
    if operation["op"] == "remove":
        del document[last]
    else:
        document[last] = deepcopy(operation["value"])


def _unescaped(part: str) -> str:
    return part.replace("~1", "/").replace("~0", "~")
