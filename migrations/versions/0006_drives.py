"""Drives on the least fuel, what was worked out about each, and the jobs that do it."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision: str = "0006"
down_revision: str | None = "0005"


def upgrade() -> None:
    """Make the tables, and let a job say which drive it is about."""
    op.create_table(
        "drives",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("kind", sa.String(length=16), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=True),
        sa.Column("problem", sa.JSON(), nullable=False),
        sa.Column("engine", sa.JSON(), nullable=True),
        sa.Column("map", sa.JSON(), nullable=True),
        sa.Column("problem_sha256", sa.String(length=64), nullable=False),
        sa.Column("fuel_energy_j", sa.Double(), nullable=True),
        sa.Column("time_s", sa.Double(), nullable=True),
        sa.Column("distance_m", sa.Double(), nullable=True),
        sa.Column("verdict", sa.String(length=32), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_drives_car_id_cars", ondelete="SET NULL"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_drives_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_drives"),
    )
    op.create_index("ix_drives_car_id", "drives", ["car_id"])
    op.create_index("ix_drives_fleet_id", "drives", ["fleet_id"])
    op.create_index("ix_drives_newest", "drives", ["fleet_id", "created_at", "id"])
    # in one statement, which SQLite takes too; made anew, the table would lose what refers to its rows
    op.execute(
        "ALTER TABLE jobs ADD COLUMN drive_id VARCHAR(32) CONSTRAINT fk_jobs_drive_id_drives REFERENCES drives (id)"
    )
    op.create_index("ix_jobs_drive_id", "jobs", ["drive_id"])
    op.create_table(
        "drive_runs",
        sa.Column("job_id", sa.String(length=32), nullable=False),
        sa.Column("drive_id", sa.String(length=32), nullable=False),
        sa.Column("work", sa.String(length=16), nullable=False),
        sa.Column("options", sa.JSON(), nullable=False),
        sa.Column("document_key", sa.String(length=300), nullable=True),
        sa.Column("provenance", sa.JSON(), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["drive_id"], ["drives.id"], name="fk_drive_runs_drive_id_drives", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_drive_runs_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["job_id"], ["jobs.id"], name="fk_drive_runs_job_id_jobs", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("job_id", name="pk_drive_runs"),
    )
    op.create_index("ix_drive_runs_drive_id_work", "drive_runs", ["drive_id", "work"])
    op.create_index("ix_drive_runs_fleet_id", "drive_runs", ["fleet_id"])


def downgrade() -> None:
    """Remove the tables with what they hold."""
    op.drop_table("drive_runs")
    op.drop_index("ix_jobs_drive_id", "jobs")
    op.drop_column("jobs", "drive_id")
    op.drop_table("drives")
