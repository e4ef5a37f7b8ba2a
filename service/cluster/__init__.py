"""The engine on many machines: records in Redis, where every replica and worker finds them.

A replica keeps a record and sends its id through Celery; a worker fetches the work, tells how it
goes, and ends the record. Messages may get lost, or come twice: what counts is in Redis.
"""
