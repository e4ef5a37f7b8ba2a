"""Worker processes: the pool, the loop inside a process, and the messages between."""
