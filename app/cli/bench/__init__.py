"""Benchmarks: each measures one thing and, in the same run, a plain way to do the same."""
