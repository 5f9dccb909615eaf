"""What the sensors can tell: rank tests, lost sensors, and information along a trip (Sebesta 2010, 3.1.2.1, A.1.2)."""
