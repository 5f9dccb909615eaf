"""Batteries of cars, what was estimated of them and from what, laboratory tests, and the jobs that do it."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision: str = "0008"
down_revision: str | None = "0007"


def upgrade() -> None:
    """Make the tables, and let a job say which battery it is about."""
    op.create_table(
        "batteries",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("config_revision", sa.Integer(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_batteries_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_batteries_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_batteries"),
        sa.UniqueConstraint("car_id", name="uq_batteries_car_id"),
    )
    op.create_index("ix_batteries_fleet_id", "batteries", ["fleet_id"])
    op.create_index("ix_batteries_newest", "batteries", ["fleet_id", "created_at", "id"])
    op.create_table(
        "battery_files",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("battery_id", sa.String(length=32), nullable=False),
        sa.Column("work", sa.String(length=16), nullable=False),
        sa.Column("name", sa.String(length=300), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("size", sa.BigInteger(), nullable=False),
        sa.Column("blob_key", sa.String(length=300), nullable=False),
        sa.Column("began_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(
            ["battery_id"], ["batteries.id"], name="fk_battery_files_battery_id_batteries", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_battery_files_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_battery_files"),
        sa.UniqueConstraint("battery_id", "work", "sha256", name="uq_battery_files_battery_id_work_sha256"),
    )
    op.create_index("ix_battery_files_fleet_id", "battery_files", ["fleet_id"])
    op.create_table(
        "battery_estimates",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("battery_id", sa.String(length=32), nullable=False),
        sa.Column("trip_id", sa.String(length=32), nullable=True),
        sa.Column("file_id", sa.String(length=32), nullable=True),
        sa.Column("source", sa.String(length=300), nullable=False),
        sa.Column("began_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("ended_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("key", sa.String(length=64), nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.Column("estimator", sa.String(length=16), nullable=False),
        sa.Column("capacity_ah", sa.Double(), nullable=True),
        sa.Column("capacity_ah_sd", sa.Double(), nullable=True),
        sa.Column("resistance_ohm", sa.Double(), nullable=True),
        sa.Column("resistance_ohm_sd", sa.Double(), nullable=True),
        sa.Column("relaxation_capacitance_f", sa.Double(), nullable=True),
        sa.Column("relaxation_capacitance_f_sd", sa.Double(), nullable=True),
        sa.Column("relaxation_resistance_ohm", sa.Double(), nullable=True),
        sa.Column("relaxation_resistance_ohm_sd", sa.Double(), nullable=True),
        sa.Column("soc", sa.Double(), nullable=True),
        sa.Column("soc_sd", sa.Double(), nullable=True),
        sa.Column("soh", sa.Double(), nullable=True),
        sa.Column("soh_sd", sa.Double(), nullable=True),
        sa.Column("current_bias_a", sa.Double(), nullable=True),
        sa.Column("current_bias_a_sd", sa.Double(), nullable=True),
        sa.Column("voltage_rms_v", sa.Double(), nullable=True),
        sa.Column("voltage_noise_v", sa.Double(), nullable=True),
        sa.Column("charge_ah", sa.Double(), nullable=True),
        sa.Column("follows_id", sa.String(length=32), nullable=True),
        sa.Column("carry", sa.JSON(), nullable=True),
        sa.Column("document_key", sa.String(length=300), nullable=True),
        sa.Column("warnings", sa.JSON(), nullable=False),
        sa.Column("provenance", sa.JSON(), nullable=False),
        sa.Column("code_version", sa.String(length=64), nullable=False),
        sa.Column("made_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(
            ["battery_id"], ["batteries.id"], name="fk_battery_estimates_battery_id_batteries", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["file_id"], ["battery_files.id"], name="fk_battery_estimates_file_id_battery_files", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_battery_estimates_fleet_id_fleets"),
        sa.ForeignKeyConstraint(
            ["trip_id"], ["trips.id"], name="fk_battery_estimates_trip_id_trips", ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name="pk_battery_estimates"),
        sa.UniqueConstraint("battery_id", "file_id", name="uq_battery_estimates_battery_id_file_id"),
        sa.UniqueConstraint("battery_id", "trip_id", name="uq_battery_estimates_battery_id_trip_id"),
    )
    op.create_index("ix_battery_estimates_file_id", "battery_estimates", ["file_id"])
    op.create_index("ix_battery_estimates_fleet_id", "battery_estimates", ["fleet_id"])
    op.create_index("ix_battery_estimates_history", "battery_estimates", ["battery_id", "began_at", "id"])
    op.create_index("ix_battery_estimates_trip_id", "battery_estimates", ["trip_id"])
    op.create_table(
        "battery_tests",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("battery_id", sa.String(length=32), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("capacity_ah", sa.Double(), nullable=False),
        sa.Column("capacity_ah_sd", sa.Double(), nullable=True),
        sa.Column("note", sa.Text(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(
            ["battery_id"], ["batteries.id"], name="fk_battery_tests_battery_id_batteries", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_battery_tests_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_battery_tests"),
    )
    op.create_index("ix_battery_tests_battery_id_at", "battery_tests", ["battery_id", "at"])
    op.create_index("ix_battery_tests_fleet_id", "battery_tests", ["fleet_id"])
    # in one statement, which SQLite takes too; made anew, the table would lose what refers to its rows
    reference = "CONSTRAINT fk_jobs_battery_id_batteries REFERENCES batteries (id)"
    op.execute(f"ALTER TABLE jobs ADD COLUMN battery_id VARCHAR(32) {reference}")
    op.create_index("ix_jobs_battery_id", "jobs", ["battery_id"])
    op.create_table(
        "battery_runs",
        sa.Column("job_id", sa.String(length=32), nullable=False),
        sa.Column("battery_id", sa.String(length=32), nullable=True),
        sa.Column("file_id", sa.String(length=32), nullable=True),
        sa.Column("work", sa.String(length=16), nullable=False),
        sa.Column("options", sa.JSON(), nullable=False),
        sa.Column("document_key", sa.String(length=300), nullable=True),
        sa.Column("provenance", sa.JSON(), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(
            ["battery_id"], ["batteries.id"], name="fk_battery_runs_battery_id_batteries", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["file_id"], ["battery_files.id"], name="fk_battery_runs_file_id_battery_files", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_battery_runs_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["job_id"], ["jobs.id"], name="fk_battery_runs_job_id_jobs", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("job_id", name="pk_battery_runs"),
    )
    op.create_index("ix_battery_runs_battery_id_work", "battery_runs", ["battery_id", "work"])
    op.create_index("ix_battery_runs_file_id", "battery_runs", ["file_id"])
    op.create_index("ix_battery_runs_fleet_id", "battery_runs", ["fleet_id"])


def downgrade() -> None:
    """Remove the tables with what they hold."""
    op.drop_table("battery_runs")
    op.drop_index("ix_jobs_battery_id", "jobs")
    op.drop_column("jobs", "battery_id")
    for name in ("battery_tests", "battery_estimates", "battery_files", "batteries"):
        op.drop_table(name)
