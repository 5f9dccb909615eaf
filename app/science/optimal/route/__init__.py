"""A road driven on the least fuel: dynamic programming over distance, energy and gear, then a polish."""
