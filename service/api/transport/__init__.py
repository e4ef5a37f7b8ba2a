"""HTTP/1.1 on sockets: connections, their bounds and deadlines, and the strict parser."""
