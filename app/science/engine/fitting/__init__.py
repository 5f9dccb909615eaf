"""Formulas through an efficiency map: polynomials of the thesis' classes (Sebesta 2010, 3.4)."""
