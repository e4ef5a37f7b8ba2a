"""Export of trained actors to ONNX files that the service runs."""
