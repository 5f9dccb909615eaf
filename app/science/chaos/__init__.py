"""Polynomial chaos: bases, Gauss's nodes and Galerkin's projection; shared by battery, inertia and traffic."""
