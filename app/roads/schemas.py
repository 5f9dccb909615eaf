"""Bodies of the roads' answers."""

from __future__ import annotations

from pydantic import ConfigDict, Field

from app.roads.models import RoadElevationTable
from app.schemas import Document, Moment


class RoadDocument(Document):
    """A table of road nodes with their altitude."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0005",
                "name": "elevation.csv",
                "nodes": 5120,
                "bounds": [49.31, 8.61, 49.45, 8.80],
                "sha256": "0e5751c026e543b2e8ab2eb06099daa1d1e5df47778f7787faab45cdf12fe3a8",
                "created_at": "2026-03-01T08:00:00Z",
            }
        }
    )

    id: str
    name: str
    nodes: int
    bounds: tuple[float, float, float, float] = Field(description="South, west, north, east, degrees.")
    sha256: str
    created_at: Moment

    @classmethod
    def of(cls, row: RoadElevationTable) -> RoadDocument:
        """Return the document of a table."""
        return cls(
            id=row.id,
            name=row.name,
            nodes=row.nodes,
            bounds=(row.south_deg, row.west_deg, row.north_deg, row.east_deg),
            sha256=row.sha256,
            created_at=row.created_at,
        )
