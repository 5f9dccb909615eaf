"""Formulas through an efficiency map: polynomials of the thesis' classes and Willans lines (Sebesta 2010, 3.4)."""
