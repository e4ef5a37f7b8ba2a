"""Tests of the README and the guide, and what makes the guide's tree and table of codes."""
