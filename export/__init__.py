"""From a checkpoint to one ONNX file that the service can serve."""
