"""Write the card of an exported actor in Markdown: its training and its figures."""

import json
from collections.abc import Mapping

from models.checkpoint import Trained
from models.config import as_plain


def card(name: str, checkpoint: str, trained: Trained, metadata: Mapping[str, str]) -> str:
    """Return the card of an actor, from its checkpoint and the metadata of its ONNX file."""
    config = as_plain(trained.config)
    sizes = json.loads(metadata["sizes"])
    figures = json.loads(metadata["figures"])
    rows = "\n".join(f"| {cities} | {100 * share:.2f} |" for cities, share in figures.items())
    return f"""# {name}

A {trained.config.network.label} network that reads {metadata["inputs"]}.
It is asked for by `"actor": "{name}"`.

## How it was trained

{trained.step} steps in {trained.seconds:.0f} seconds, on {sizes[0]} to {sizes[1]} cities.
Exported from `{checkpoint}` by the code at {metadata["commit"]}.

```json
{json.dumps(config, indent=2)}
```

## What it reaches

Mean hypervolume over the validation instances, in per cent of the box to (n, n), greedy:

| cities | hypervolume, % |
|---|---|
{rows}
"""
