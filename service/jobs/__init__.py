"""Jobs: their records, the store, the queue, and the engine of a single machine."""
