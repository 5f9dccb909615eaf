"""Joint Kalman filters: a cell's state and its parameters estimated together, each with its uncertainty."""
