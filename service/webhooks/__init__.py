"""Tell webhooks that jobs have ended: by signed posts to allowed targets, repeated on failure."""
