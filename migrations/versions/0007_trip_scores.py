"""The newest score of each trip."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision: str = "0007"
down_revision: str | None = "0006"


def upgrade() -> None:
    """Make the table; trips that are there are scored when somebody asks for it."""
    op.create_table(
        "trip_scores",
        sa.Column("trip_id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("key", sa.String(length=64), nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.Column("score", sa.Double(), nullable=True),
        sa.Column("score_sd", sa.Double(), nullable=True),
        sa.Column("fuel_l", sa.Double(), nullable=True),
        sa.Column("saved_l", sa.Double(), nullable=True),
        sa.Column("saved_sd_l", sa.Double(), nullable=True),
        sa.Column("distance_m", sa.Double(), nullable=True),
        sa.Column("advice", sa.JSON(), nullable=False),
        sa.Column("map_version", sa.Integer(), nullable=True),
        sa.Column("document_key", sa.String(length=300), nullable=True),
        sa.Column("provenance", sa.JSON(), nullable=False),
        sa.Column("code_version", sa.String(length=64), nullable=False),
        sa.Column("scored_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_trip_scores_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_trip_scores_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["trip_id"], ["trips.id"], name="fk_trip_scores_trip_id_trips", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("trip_id", name="pk_trip_scores"),
    )
    op.create_index("ix_trip_scores_best", "trip_scores", ["fleet_id", "score", "trip_id"])
    op.create_index("ix_trip_scores_car_id", "trip_scores", ["car_id"])
    op.create_index("ix_trip_scores_fleet_id", "trip_scores", ["fleet_id"])


def downgrade() -> None:
    """Remove the table with what it holds."""
    op.drop_table("trip_scores")
