"""Measures what accuracy costs on a set and a shot of one's own: `python3 -m shadowcache_trade --help`."""
