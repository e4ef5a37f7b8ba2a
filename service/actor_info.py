"""Read the metadata of an actor's ONNX file without its network.

This module does not import ONNX Runtime, because that starts threads, and a process with threads
cannot be forked. Opening a network for inference would also take up to two seconds.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError, Message
from paretour.values import Actor

from service.instance import Kind
from service.objectives import MOST_OBJECTIVES, OBJECTIVES

RELEASED = Path(__file__).parent / "actors"
_METADATA = ("name", "config", "commit", "sizes", "angles", "figures", "inputs")
# The part of onnx.proto that is read here: the number of each field of a message, and its type
# unless that is text.
_FIELDS: dict[str, dict[str, tuple[int, str | None]]] = {
    "Model": {"graph": (7, "Graph"), "metadata_props": (14, "Entry")},
    "Graph": {"input": (11, "Value")},
    "Value": {"name": (1, None)},
    "Entry": {"key": (1, None), "value": (2, None)},
}


@dataclass(frozen=True, kw_only=True)
class ActorInfo(Actor):
    """The metadata of an actor's ONNX file.

    Its `inputs` are `coordinates`, shape (n, 2 m), each plane moved and scaled into the unit
    square; or `matrices`, shape (m, n, n), in units of the scale, with zeros on the diagonal.
    """

    inputs: Kind

    @property
    def identity(self) -> dict[str, str]:
        """The name and digest, as answers report them."""
        return {"name": self.name, "digest": self.digest}

    def serves(self, kind: Kind, objectives: int = OBJECTIVES) -> bool:
        """Return whether it builds tours for instances of a kind: matrices serve both kinds."""
        return self.inputs in ("matrices", kind) and objectives <= self.most_objectives


def read_actor_infos(directory: Path, own_directory: Path | None = None) -> dict[Path, ActorInfo]:
    """Return the metadata of the ONNX files in a directory, and in one of the user's, by path.

    Raises:
        ValueError: A directory has no ONNX file, one is not an actor, or two have the same name.
    """
    files = onnx_files(directory, own_directory)
    infos = {path: read_actor_info(path.read_bytes(), path) for path in files}
    check_names(infos)
    return infos


def onnx_files(directory: Path, own_directory: Path | None = None) -> list[Path]:
    """Return the ONNX files of a directory, and of one of the user's.

    Raises:
        ValueError: A directory has none.
    """
    files: list[Path] = []
    for folder in [directory] if own_directory is None else [directory, own_directory]:
        found = sorted(folder.glob("*.onnx"))
        if not found:
            raise ValueError(f"{folder} must hold ONNX files, got none")
        files += found
    return files


def check_names(infos: Mapping[Path, ActorInfo]) -> None:
    """Raise ValueError if two files hold actors of the same name."""
    paths: dict[str, Path] = {}
    for path, info in infos.items():
        if (other := paths.setdefault(info.name, path)) is not path:
            both = f"{other} and {path}"
            raise ValueError(
                f"ONNX files must hold actors of different names, got {info.name} in {both}"
            )


def read_actor_info(content: bytes, path: Path) -> ActorInfo:
    """Return the metadata of an actor from the content of its ONNX file. Errors name its path.

    Raises:
        ValueError: It is not ONNX, lacks metadata, or reads neither coordinates nor matrices.
    """
    model = _parsed(content, path)
    metadata = {entry.key: entry.value for entry in model.metadata_props}
    if missing := [name for name in _METADATA if name not in metadata]:
        raise ValueError(f"the metadata of {path} must have {', '.join(missing)}")
    inputs: Any = metadata["inputs"]
    if inputs not in get_args(Kind):
        raise ValueError(f"inputs of {path} must be coordinates or matrices, got {inputs!r}")
    return ActorInfo(
        digest=hashlib.sha256(content).hexdigest(),
        inputs=inputs,
        repairs=any(value.name == "repairs" for value in model.graph.input),
        most_objectives=_most_objectives(metadata, path),
        **{name: metadata[name] for name in ("name", "commit")},
        **{name: _decoded(metadata[name]) for name in ("sizes", "angles", "config", "figures")},
    )


def _most_objectives(metadata: Mapping[str, str], path: Path) -> int:
    """Return the most objectives that a file takes: two, unless it says more."""
    text = metadata.get("objectives", str(OBJECTIVES))
    if text not in map(str, range(OBJECTIVES, MOST_OBJECTIVES + 1)):
        demand = f"must be from {OBJECTIVES} to {MOST_OBJECTIVES}"
        raise ValueError(f"objectives of {path} {demand}, got {text!r}")
    return int(text)


def _parsed(content: bytes, path: Path) -> Any:
    """Return a model of onnx.proto with the members in `_FIELDS`."""
    model = _MODEL()
    try:
        model.ParseFromString(content)
    except DecodeError as error:
        raise ValueError(f"{path} must be an ONNX file that can be read: {error}") from error
    if not model.HasField("graph"):
        raise ValueError(f"{path} must be an ONNX file that can be read: it has no graph")
    return model


def _model_class() -> type[Message]:
    file = descriptor_pb2.FileDescriptorProto(name="paretour/onnx.proto", package="paretour")
    field = descriptor_pb2.FieldDescriptorProto
    for name, members in _FIELDS.items():
        message = file.message_type.add(name=name)
        for member, (number, of) in members.items():
            repeated = member in ("metadata_props", "input")
            message.field.add(
                name=member,
                number=number,
                label=field.LABEL_REPEATED if repeated else field.LABEL_OPTIONAL,
                type=field.TYPE_MESSAGE if of else field.TYPE_STRING,
                type_name=f".paretour.{of}" if of else None,
            )
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("paretour.Model"))


_MODEL = _model_class()


def _decoded(text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text
