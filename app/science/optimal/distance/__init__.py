"""The least fuel over a distance on the level, in any time, to any speed at its end (Sebesta 2010, 4.5)."""
