"""Replan: search on from the tours of an earlier front, and keep legs of the driven one."""
