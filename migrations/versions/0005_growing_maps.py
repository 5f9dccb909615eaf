"""What changed with each map, which trips count in a car's maps, and tables to lay over them."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision: str = "0005"
down_revision: str | None = "0004"


def upgrade() -> None:
    """Make the tables; of the maps that are there nobody asked what changed."""
    op.add_column("map_versions", sa.Column("changes", sa.JSON(), nullable=True))
    op.create_table(
        "map_rules",
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("verdicts", sa.String(length=16), nullable=False),
        sa.Column("smoothed_only", sa.Boolean(), nullable=False),
        sa.Column("torque_source", sa.String(length=16), nullable=False),
        sa.Column("since", sa.DateTime(timezone=True), nullable=True),
        sa.Column("until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_map_rules_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_map_rules_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("car_id", name="pk_map_rules"),
    )
    op.create_index("ix_map_rules_fleet_id", "map_rules", ["fleet_id"])
    op.create_table(
        "map_references",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("fuel", sa.String(length=16), nullable=False),
        sa.Column("filename", sa.String(length=300), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("points", sa.Integer(), nullable=False),
        sa.Column("data", sa.LargeBinary(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_map_references_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_map_references_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_map_references"),
    )
    op.create_index("ix_map_references_car_id", "map_references", ["car_id"])
    op.create_index("ix_map_references_fleet_id", "map_references", ["fleet_id"])


def downgrade() -> None:
    """Remove the tables with what they hold."""
    op.drop_table("map_references")
    op.drop_table("map_rules")
    op.drop_column("map_versions", "changes")
