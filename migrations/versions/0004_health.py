"""The cars' health: the newest assessment of each, and what was told about it."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision: str = "0004"
down_revision: str | None = "0003"


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "car_health",
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("key", sa.String(length=64), nullable=True),
        sa.Column("document", sa.JSON(), nullable=True),
        sa.Column("left_out", sa.JSON(), nullable=False),
        sa.Column("code_version", sa.String(length=64), nullable=True),
        sa.Column("assessed_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("usual_since", sa.DateTime(timezone=True), nullable=True),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_car_health_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_car_health_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("car_id", name="pk_car_health"),
    )
    op.create_index("ix_car_health_fleet_id", "car_health", ["fleet_id"])
    op.create_table(
        "health_alerts",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("quantity", sa.String(length=32), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("since_trip_id", sa.String(length=32), nullable=True),
        sa.Column("since_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("trips", sa.Integer(), nullable=False),
        sa.Column("change", sa.Double(), nullable=False),
        sa.Column("change_sd", sa.Double(), nullable=False),
        sa.Column("unit", sa.String(length=16), nullable=False),
        sa.Column("chance", sa.Double(), nullable=False),
        sa.Column("other", sa.String(length=32), nullable=False),
        sa.Column("words", sa.Text(), nullable=False),
        sa.Column("advice", sa.Text(), nullable=False),
        sa.Column("seen_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("seen_by", sa.String(length=320), nullable=True),
        sa.Column("cleared_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("cleared_words", sa.Text(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_health_alerts_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_health_alerts_fleet_id_fleets"),
        sa.ForeignKeyConstraint(
            ["since_trip_id"], ["trips.id"], name="fk_health_alerts_since_trip_id_trips", ondelete="SET NULL"
        ),
        sa.PrimaryKeyConstraint("id", name="pk_health_alerts"),
    )
    op.create_index("ix_health_alerts_car_id_state", "health_alerts", ["car_id", "state"])
    op.create_index("ix_health_alerts_fleet_id", "health_alerts", ["fleet_id"])
    op.create_index("ix_health_alerts_newest", "health_alerts", ["fleet_id", "created_at", "id"])


def downgrade() -> None:
    """Remove the tables with what they hold."""
    op.drop_table("health_alerts")
    op.drop_table("car_health")
