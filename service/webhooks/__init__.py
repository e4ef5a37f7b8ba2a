"""Post the ends of jobs to webhooks: signed, to allowed targets alone, and again after failures."""
