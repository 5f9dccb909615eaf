"""Where a car's XML came from, and what was filled into the tank after a trip."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision: str = "0002"
down_revision: str | None = "0001"


def upgrade() -> None:
    """Add the columns; what is there already says nothing of either."""
    op.add_column("car_config_revisions", sa.Column("note", sa.Text(), nullable=False, server_default=""))
    op.add_column("trips", sa.Column("refuelled_l", sa.Double(), nullable=True))


def downgrade() -> None:
    """Remove the columns."""
    op.drop_column("trips", "refuelled_l")
    op.drop_column("car_config_revisions", "note")
