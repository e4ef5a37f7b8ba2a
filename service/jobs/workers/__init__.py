"""Worker processes: what runs in one, how many there are, and what they tell the service."""
