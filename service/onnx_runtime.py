"""Import ONNX Runtime with its telemetry off. All other modules must import it from here.

With its telemetry on, ONNX Runtime writes an identifier of the device and a database of events into
the user's cache when it is imported, and sends these events to its maker.
"""

import os

os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")  # read when it is imported

import onnxruntime

__all__ = ["onnxruntime"]
