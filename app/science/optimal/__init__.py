"""Driving on the least fuel: problems, their solution, and what certifies it (Sebesta 2010, ch. 4, App. B, G)."""
