"""Every table of the first service, and the fleet that an embedded Ponthy works for."""

from __future__ import annotations

from datetime import UTC, datetime

import sqlalchemy as sa
from alembic import op

revision: str = "0001"
down_revision: str | None = None

DEFAULT_FLEET_ID = "0" * 31 + "1"


def upgrade() -> None:
    """Make the tables and the default fleet."""
    op.create_table(
        "fleets",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_fleets"),
    )
    op.create_table(
        "login_failures",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("who_hash", sa.String(length=64), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_login_failures"),
    )
    op.create_index("ix_login_failures_at", "login_failures", ["at"])
    op.create_index("ix_login_failures_who_hash", "login_failures", ["who_hash"])
    op.create_table(
        "api_tokens",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("prefix", sa.String(length=16), nullable=False),
        sa.Column("secret_hash", sa.String(length=64), nullable=False),
        sa.Column("scope", sa.String(length=16), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("last_used_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("revoked_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_api_tokens_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_api_tokens"),
        sa.UniqueConstraint("prefix", name="uq_api_tokens_prefix"),
    )
    op.create_index("ix_api_tokens_fleet_id", "api_tokens", ["fleet_id"])
    op.create_table(
        "cars",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("title", sa.String(length=300), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("config_sha256", sa.String(length=64), nullable=False),
        sa.Column("load_kg", sa.Double(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("updated_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_cars_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_cars"),
    )
    op.create_index("ix_cars_fleet_id", "cars", ["fleet_id"])
    op.create_index("ix_cars_newest", "cars", ["fleet_id", "created_at", "id"])
    op.create_table(
        "road_elevations",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=255), nullable=False),
        sa.Column("nodes", sa.Integer(), nullable=False),
        sa.Column("south_deg", sa.Double(), nullable=False),
        sa.Column("west_deg", sa.Double(), nullable=False),
        sa.Column("north_deg", sa.Double(), nullable=False),
        sa.Column("east_deg", sa.Double(), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("blob_key", sa.String(length=300), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_road_elevations_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_road_elevations"),
        sa.UniqueConstraint("fleet_id", "sha256", name="uq_road_elevations_fleet_id_sha256"),
    )
    op.create_index("ix_road_elevations_fleet_id", "road_elevations", ["fleet_id"])
    op.create_index("ix_road_elevations_newest", "road_elevations", ["fleet_id", "created_at", "id"])
    op.create_table(
        "users",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("email", sa.String(length=320), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("password_hash", sa.String(length=300), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_users_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_users"),
        sa.UniqueConstraint("email", name="uq_users_email"),
    )
    op.create_index("ix_users_fleet_id", "users", ["fleet_id"])
    op.create_table(
        "car_config_revisions",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("xml", sa.LargeBinary(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(
            ["car_id"], ["cars.id"], name="fk_car_config_revisions_car_id_cars", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_car_config_revisions_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_car_config_revisions"),
        sa.UniqueConstraint("car_id", "number", name="uq_car_config_revisions_car_id_number"),
    )
    op.create_index("ix_car_config_revisions_car_id", "car_config_revisions", ["car_id"])
    op.create_index("ix_car_config_revisions_fleet_id", "car_config_revisions", ["fleet_id"])
    op.create_table(
        "login_sessions",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("user_id", sa.String(length=32), nullable=False),
        sa.Column("secret_hash", sa.String(length=64), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_login_sessions_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["user_id"], ["users.id"], name="fk_login_sessions_user_id_users", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name="pk_login_sessions"),
        sa.UniqueConstraint("secret_hash", name="uq_login_sessions_secret_hash"),
    )
    op.create_index("ix_login_sessions_expires_at", "login_sessions", ["expires_at"])
    op.create_index("ix_login_sessions_fleet_id", "login_sessions", ["fleet_id"])
    op.create_index("ix_login_sessions_user_id", "login_sessions", ["user_id"])
    op.create_table(
        "map_versions",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.Column("key", sa.String(length=64), nullable=False),
        sa.Column("cells", sa.Integer(), nullable=False),
        sa.Column("trusted_cells", sa.Integer(), nullable=False),
        sa.Column("points", sa.Integer(), nullable=False),
        sa.Column("trips", sa.Integer(), nullable=False),
        sa.Column("best", sa.JSON(), nullable=True),
        sa.Column("provenance", sa.JSON(), nullable=False),
        sa.Column("document_key", sa.String(length=300), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_map_versions_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_map_versions_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_map_versions"),
        sa.UniqueConstraint("car_id", "version", name="uq_map_versions_car_id_version"),
    )
    op.create_index("ix_map_versions_fleet_id", "map_versions", ["fleet_id"])
    op.create_table(
        "uploads",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=True),
        sa.Column("kind", sa.String(length=16), nullable=False),
        sa.Column("filename", sa.String(length=255), nullable=False),
        sa.Column("mapping", sa.JSON(), nullable=True),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("size", sa.BigInteger(), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=True),
        sa.Column("content_key", sa.String(length=160), nullable=True),
        sa.Column("blob_key", sa.String(length=300), nullable=True),
        sa.Column("duplicate", sa.Boolean(), nullable=False),
        sa.Column("duplicate_of", sa.String(length=32), nullable=True),
        sa.Column("problem", sa.JSON(), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("updated_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("completed_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_uploads_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(
            ["duplicate_of"], ["uploads.id"], name="fk_uploads_duplicate_of_uploads", ondelete="SET NULL"
        ),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_uploads_fleet_id_fleets"),
        sa.PrimaryKeyConstraint("id", name="pk_uploads"),
        sa.UniqueConstraint("fleet_id", "content_key", name="uq_uploads_fleet_id_content_key"),
    )
    op.create_index("ix_uploads_car_id", "uploads", ["car_id"])
    op.create_index("ix_uploads_duplicate_of", "uploads", ["duplicate_of"])
    op.create_index("ix_uploads_expires_at", "uploads", ["expires_at"])
    op.create_index("ix_uploads_fleet_id", "uploads", ["fleet_id"])
    op.create_index("ix_uploads_newest", "uploads", ["fleet_id", "created_at", "id"])
    op.create_table(
        "trips",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("upload_id", sa.String(length=32), nullable=False),
        sa.Column("segment", sa.Integer(), nullable=False),
        sa.Column("input_key", sa.String(length=300), nullable=False),
        sa.Column("input_sha256", sa.String(length=64), nullable=False),
        sa.Column("input_bytes", sa.BigInteger(), nullable=False),
        sa.Column("mapping", sa.JSON(), nullable=True),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("filename", sa.String(length=300), nullable=False),
        sa.Column("notes", sa.Text(), nullable=False),
        sa.Column("in_map", sa.Boolean(), nullable=False),
        sa.Column("options", sa.JSON(), nullable=False),
        sa.Column("decode_key", sa.String(length=64), nullable=True),
        sa.Column("observe_key", sa.String(length=64), nullable=True),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("duration_s", sa.Double(), nullable=True),
        sa.Column("distance_m", sa.Double(), nullable=True),
        sa.Column("fuel_l", sa.Double(), nullable=True),
        sa.Column("fuel_energy_j", sa.Double(), nullable=True),
        sa.Column("verdict", sa.String(length=16), nullable=True),
        sa.Column("reasons", sa.JSON(), nullable=False),
        sa.Column("warnings", sa.JSON(), nullable=False),
        sa.Column("consistency", sa.JSON(), nullable=False),
        sa.Column("filter", sa.String(length=16), nullable=True),
        sa.Column("tuning", sa.String(length=200), nullable=True),
        sa.Column("smoothed", sa.Boolean(), nullable=True),
        sa.Column("code_version", sa.String(length=64), nullable=True),
        sa.Column("provenance", sa.JSON(), nullable=False),
        sa.Column("summary", sa.JSON(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_trips_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_trips_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["upload_id"], ["uploads.id"], name="fk_trips_upload_id_uploads", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name="pk_trips"),
        sa.UniqueConstraint("upload_id", "segment", name="uq_trips_upload_id_segment"),
    )
    op.create_index("ix_trips_car_id", "trips", ["car_id"])
    op.create_index("ix_trips_fleet_id", "trips", ["fleet_id"])
    op.create_index("ix_trips_newest", "trips", ["fleet_id", "created_at", "id"])
    op.create_index("ix_trips_upload_id", "trips", ["upload_id"])
    op.create_table(
        "jobs",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("kind", sa.String(length=16), nullable=False),
        sa.Column("title", sa.String(length=300), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("trip_id", sa.String(length=32), nullable=True),
        sa.Column("car_id", sa.String(length=32), nullable=True),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("owner", sa.String(length=32), nullable=True),
        sa.Column("lease_until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("offered_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("cancel_requested", sa.Boolean(), nullable=False),
        sa.Column("problem", sa.JSON(), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_jobs_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_jobs_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["trip_id"], ["trips.id"], name="fk_jobs_trip_id_trips", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name="pk_jobs"),
    )
    op.create_index("ix_jobs_car_id", "jobs", ["car_id"])
    op.create_index("ix_jobs_fleet_id", "jobs", ["fleet_id"])
    op.create_index("ix_jobs_newest", "jobs", ["fleet_id", "created_at", "id"])
    op.create_index("ix_jobs_open", "jobs", ["state", "offered_at"])
    op.create_index("ix_jobs_trip_id", "jobs", ["trip_id"])
    op.create_table(
        "trip_cells",
        sa.Column("trip_id", sa.String(length=32), nullable=False),
        sa.Column("car_id", sa.String(length=32), nullable=False),
        sa.Column("key", sa.String(length=64), nullable=False),
        sa.Column("points", sa.Integer(), nullable=False),
        sa.Column("torque_source", sa.String(length=16), nullable=False),
        sa.Column("sums", sa.LargeBinary(), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["car_id"], ["cars.id"], name="fk_trip_cells_car_id_cars", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_trip_cells_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["trip_id"], ["trips.id"], name="fk_trip_cells_trip_id_trips", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("trip_id", name="pk_trip_cells"),
    )
    op.create_index("ix_trip_cells_car_id", "trip_cells", ["car_id"])
    op.create_index("ix_trip_cells_fleet_id", "trip_cells", ["fleet_id"])
    op.create_table(
        "job_events",
        sa.Column("id", sa.Integer(), autoincrement=True, nullable=False),
        sa.Column("job_id", sa.String(length=32), nullable=False),
        sa.Column("kind", sa.String(length=16), nullable=False),
        sa.Column("data", sa.JSON(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_job_events_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["job_id"], ["jobs.id"], name="fk_job_events_job_id_jobs", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name="pk_job_events"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_job_events_fleet_id", "job_events", ["fleet_id"])
    op.create_index("ix_job_events_job_id_id", "job_events", ["job_id", "id"])
    op.create_table(
        "job_stages",
        sa.Column("id", sa.Integer(), autoincrement=True, nullable=False),
        sa.Column("job_id", sa.String(length=32), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(length=32), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("progress", sa.Double(), nullable=False),
        sa.Column("detail", sa.String(length=300), nullable=True),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("fleet_id", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["fleet_id"], ["fleets.id"], name="fk_job_stages_fleet_id_fleets"),
        sa.ForeignKeyConstraint(["job_id"], ["jobs.id"], name="fk_job_stages_job_id_jobs", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name="pk_job_stages"),
        sa.UniqueConstraint("job_id", "position", name="uq_job_stages_job_id_position"),
    )
    op.create_index("ix_job_stages_fleet_id", "job_stages", ["fleet_id"])
    fleets = sa.table("fleets", sa.column("id"), sa.column("name"), sa.column("created_at", sa.DateTime(timezone=True)))
    op.bulk_insert(fleets, [{"id": DEFAULT_FLEET_ID, "name": "My fleet", "created_at": datetime.now(UTC)}])


def downgrade() -> None:
    """Remove everything."""
    metadata = sa.MetaData()
    metadata.reflect(op.get_bind(), only=lambda name, _: name != "alembic_version")
    metadata.drop_all(op.get_bind())
