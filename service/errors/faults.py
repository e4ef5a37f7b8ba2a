"""The faults of the parts of a request, and what would help: a code each, and values.

Their sentences are in `sentences.toml` and `remedies.toml`. A part is named as the caller wrote it,
as stops/3/window.
"""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from string import Formatter
from typing import Any

from pydantic_core import to_json

_LONGEST_NAME = 100  # characters of a caller's name, where it is quoted
_LONGEST_SHOWN = 80  # characters of what came
Value = float | str
_SENTENCES, _REMEDIES = (
    Path(__file__).with_name(name).read_text(encoding="utf-8")
    for name in ("sentences.toml", "remedies.toml")
)
SENTENCES: Mapping[str, str] = tomllib.loads(_SENTENCES)
REMEDIES: Mapping[str, str] = tomllib.loads(_REMEDIES)


@dataclass(frozen=True)
class Fault:
    """One thing wrong with a request.

    Args:
        code: One of SENTENCES; with `said`, that of a refusal, or of an error of pydantic.
        part: The part at fault, as stops/3/window, with which the sentence begins; None where the
            sentence names it.
        pointer: The part as a JSON pointer into the body (RFC 6901).
        parameter: The query parameter at fault.
        values: The values of the sentence. `came` is what came, `near` what was probably meant,
            and `other` the pointer to another part.
        said: The sentence after the part, where it is another's than that of SENTENCES.
    """

    code: str
    part: str | None = None
    pointer: str | None = None
    parameter: str | None = None
    values: Mapping[str, Any] = field(default_factory=dict)
    said: str = ""

    @classmethod
    def of(cls, part: str, code: str, **values: object) -> "Fault":
        """Return a fault of a part of the body."""
        return cls(code, part, f"/{part}", values=values)

    @property
    def demand(self) -> str:
        """What is demanded of the part, and what came: the sentence after the part."""
        demand = self.said or said(SENTENCES[self.code], self.values)
        near = self.values.get("near")
        if near is None:
            return demand
        return f"{demand}; did you mean {show(near) if 'came' in self.values else near}?"

    @property
    def detail(self) -> str:
        """The whole sentence."""
        return self.demand if self.part is None else f"{self.part} {self.demand}"

    @property
    def document(self) -> dict[str, Any]:
        """The fault as a member of a problem document, without what is not known."""
        members = {
            "detail": self.detail,
            "pointer": self.pointer,
            "parameter": self.parameter,
            "code": self.code,
            "demand": None if self.part is None else self.demand,
            "values": {k: _plain(k, v) for k, v in self.values.items() if v is not None} or None,
        }
        return {name: value for name, value in members.items() if value is not None}


@dataclass(frozen=True)
class Remedy:
    """A change to a refused request after which it is planned, as was tried.

    Args:
        code: One of REMEDIES.
        patch: The change, as the operations of a JSON patch (RFC 6902).
        values: The values of its sentence.
    """

    code: str
    patch: tuple[Mapping[str, Any], ...]
    values: Mapping[str, Value]

    @property
    def document(self) -> dict[str, Any]:
        """The remedy as a member of a problem document."""
        return {
            "code": self.code,
            "detail": said(REMEDIES[self.code], self.values),
            "values": dict(self.values),
            "patch": list(self.patch),
        }


def said(sentence: str, values: Mapping[str, object]) -> str:
    """Return a sentence with its values in place of its fields.

    `{came!j}` is shown as JSON, and `{came!q}` in quotation marks; `{other!p}` is a pointer without
    its first slash; `{because}` is the sentence of another code with the same values.
    """
    return _Sentence().vformat(sentence, (), values)


class _Sentence(Formatter):
    def get_value(self, key: int | str, args: Any, kwargs: Mapping[str, Any]) -> Any:
        value = super().get_value(key, args, kwargs)
        return said(SENTENCES[value], kwargs) if key == "because" else value

    def convert_field(self, value: Any, conversion: Any) -> Any:
        match conversion:
            case "j":
                return show(value)
            case "q":
                return quoted(value, _LONGEST_SHOWN)
            case "p":
                return value[1:]
        return super().convert_field(value, conversion)

    def format_field(self, value: Any, format_spec: str) -> Any:
        if isinstance(value, float) and not format_spec:
            return show(value)
        return super().format_field(value, format_spec)


def _plain(name: str, value: Any) -> Value:
    """Return a value as a number or a text: what came in JSON, other texts as they are."""
    if isinstance(value, str) and name != "came":
        return shorten(value)
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) < 10**40:
        return value
    return value if isinstance(value, float) and math.isfinite(value) else show(value)


def shorten(text: str) -> str:
    """Return the first characters of what came, to be shown in a sentence."""
    return text if len(text) <= _LONGEST_SHOWN else f"{text[: _LONGEST_SHOWN - 1]}…"


def show(value: object) -> str:
    """Return what came as a short text, to be shown in a sentence."""
    match value:
        case list():
            return f"a list of {len(value)}"
        case dict():
            return "an object"
        case int() if abs(value) >= 10**40:
            return "an integer of more than 40 digits"
        case _:
            return shorten(to_json(value, inf_nan_mode="constants").decode())


def quoted(text: object, most: int = _LONGEST_NAME) -> str:
    """Return the beginning of a text, such as a name, in quotation marks."""
    return repr(str(text)[:most])
