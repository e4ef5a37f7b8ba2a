"""Planning fleets in a worker process: from a task to the JSON of its front of plans."""
