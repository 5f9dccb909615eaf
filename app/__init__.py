"""Ponthy: each car's truth, from a cheap logger."""

__version__ = "0.1.0"
