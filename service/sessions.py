"""Inference sessions of networks, whose graphs are optimised once.

ONNX Runtime optimises a graph each time that it opens a file. Of PA-One, whose graph has thousands
of operations, that takes a second. So the optimised graphs of the released networks are kept beside
the compiled code, and later sessions are opened from there in a quarter of the time. They build the
same tours.
"""

import logging
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

from service import jit
from service.actor_info import RELEASED
from service.onnx_runtime import onnxruntime

_LOG = logging.getLogger("paretour")
_DIGEST_SIZE = 32  # bytes, of SHA-256


def open_session(content: bytes, path: Path, threads: int) -> onnxruntime.InferenceSession:
    """Open a session that runs in a number of threads, for the content of an ONNX file.

    Args:
        path: Where the file lies. The optimised graph of a released network is kept.

    Raises:
        ValueError: ONNX Runtime cannot run it.
    """
    try:
        folder = jit.folder() if path.parent == RELEASED else None
        if folder is None:
            return _session(content, _options(threads))
        return _released(content, folder, path, threads)
    except Exception as error:  # ONNX Runtime has a class for each of its codes, and no common one
        reason = _first_line(error)
        raise ValueError(f"{path} must be an ONNX file that can be read: {reason}") from error


def _released(
    content: bytes, folder: Path, path: Path, threads: int
) -> onnxruntime.InferenceSession:
    """Open a session from the graph that is kept, or keep it."""
    digest = sha256(onnxruntime.__version__.encode() + content).hexdigest()
    kept = folder / f"{path.stem}-{digest[:16]}.ort"
    optimised = _read(kept)
    if optimised is None:
        try:
            with jit.locked(path):  # of processes that open it together, one optimises it
                if (optimised := _read(kept)) is None:
                    return _session_to_keep(content, kept, threads)
        except Exception as error:  # ONNX Runtime has no class of its own for a failure to write
            session = _session(content, _options(threads))  # fails again if the file is at fault
            _LOG.warning("the optimised %s cannot be kept: %s", path.name, _first_line(error))
            return session
    return _session(optimised, _options(threads))


def _session_to_keep(content: bytes, kept: Path, threads: int) -> onnxruntime.InferenceSession:
    kept.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(dir=kept.parent) as folder:
        written = Path(folder, kept.name)
        options = _options(threads)
        # What is optimised beyond is for one kind of processor.
        options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_ENABLE_EXTENDED
        options.optimized_model_filepath = str(written)
        options.add_session_config_entry("session.save_model_format", "ORT")
        session = _session(content, options)
        optimised = written.read_bytes()
        written.write_bytes(sha256(optimised).digest() + optimised)
        written.replace(kept)
    return session


def _read(kept: Path) -> bytes | None:
    """Return a graph that is kept; None if there is none that can be read, or it is damaged."""
    with suppress(OSError):
        content = kept.read_bytes()
        digest, optimised = content[:_DIGEST_SIZE], content[_DIGEST_SIZE:]
        if sha256(optimised).digest() == digest:
            return optimised
    return None


def _session(content: bytes, options: onnxruntime.SessionOptions) -> onnxruntime.InferenceSession:
    return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]


def _options(threads: int) -> onnxruntime.SessionOptions:
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    # Planning memory for the shapes of a call takes 2 to 3 % of it, and the shapes rarely recur.
    options.enable_mem_pattern = False
    # Threads that spin while they wait would slow down the plans of other processes.
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return options
