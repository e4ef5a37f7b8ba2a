"""The page's modules in a process of Node: those that need no document, and no browser to start.

The wheel of playwright brings Node.
"""

import json
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import playwright

SERVICE = Path(__file__).parents[2] / "service"
NODE = Path(playwright.__file__).parent / "driver" / "node"
# Each line that comes in is a function and its argument, as JSON; each that goes out what it did.
EVALUATE = """
import { createInterface } from "node:readline";
for await (const line of createInterface({ input: process.stdin })) {
  const [source, argument] = JSON.parse(line);
  const answer = {};
  try {
    answer.value = await eval(`(${source})`)(argument);
  } catch (error) {
    answer.error = error.stack;
  }
  process.stdout.write(`${JSON.stringify(answer)}\\n`);
}
"""


class Node:
    """A process of Node in which functions are evaluated, as in a page of playwright."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def evaluate(self, source: str, argument: Any = None) -> Any:
        """Return what a function of JavaScript returns, which may import from `./page`."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(f"{json.dumps([source, argument])}\n")
        self._process.stdin.flush()
        answer = json.loads(self._process.stdout.readline())
        assert "error" not in answer, answer["error"]
        return answer.get("value")

    def call(self, module: str, name: str, *arguments: Any) -> Any:
        """Return what a function of one of the page's modules returns, such as "common/axes.js"."""
        source = "async ([path, name, given]) => (await import(path))[name](...given)"
        return self.evaluate(source, [f"./page/{module}", name, arguments])


@contextmanager
def node_process() -> Iterator[Node]:
    """Run Node until the block ends."""
    command = [str(NODE), "--no-warnings", "--input-type=module", "--eval", EVALUATE]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, cwd=SERVICE, stdin=pipe, stdout=pipe, text=True) as process:
        yield Node(process)
