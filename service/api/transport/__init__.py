"""HTTP/1.1 on sockets: connections, bounds, deadlines, trusted proxies, the strict parser."""
