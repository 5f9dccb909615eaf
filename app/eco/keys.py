"""Where the scores lie among the files."""

from __future__ import annotations

from app.trips import service as trips

DOCUMENT = "score.json"
COLUMNS = "score.parquet"


def scores_folder(trip: trips.ObservedTrip) -> str:
    """Return where the scores of a run of the observer lie; they go with it."""
    return f"{trip.folder}/scores"


def score_folder(trip: trips.ObservedTrip, key: str) -> str:
    """Return where one score lies; what another question gave is never touched."""
    return f"{scores_folder(trip)}/{key}"
