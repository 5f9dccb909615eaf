"""Every setting of the service, and the one place that knows whether it runs embedded, on a server or as a fleet.

Each field can be set by an environment variable with the prefix ``PONTHY_``: ``PONTHY_DATABASE_URL``,
``PONTHY_BLOB_URL`` and so on.
"""

from __future__ import annotations

from functools import cached_property
from ipaddress import ip_address
from pathlib import Path

from pydantic import Field, SecretStr
from pydantic_settings import BaseSettings, SettingsConfigDict

from app import __version__
from app.science.fingerprint import science_fingerprint

GIB = 1024**3


class Settings(BaseSettings):
    """What can be configured, with the defaults of the embedded size."""

    model_config = SettingsConfigDict(env_prefix="PONTHY_", extra="ignore")

    data_dir: Path = Field(Path("var"), description="Folder for everything that is kept, unless a URL below says else.")
    host: str = Field("127.0.0.1", description="Address the web server listens on; a loopback one needs no login.")
    port: int = Field(8321, ge=0, le=65535, description="Port the web server listens on.")
    auth: bool | None = Field(None, description="Ask for a login: yes, no, or (unset) only off loopback.")
    public_url: str | None = Field(None, description="Address people use, when a proxy stands in front.")
    database_url: SecretStr | None = Field(None, description="PostgreSQL URL; unset: SQLite in the data folder.")
    broker_url: SecretStr | None = Field(
        None, description="Redis URL of the queue; unset: a folder in the data folder."
    )
    blob_url: str | None = Field(None, description="s3://bucket/prefix for files; unset: a folder in the data folder.")
    s3_endpoint: str | None = Field(None, description="Endpoint of an S3-compatible store that isn't AWS.")
    max_upload_bytes: int = Field(4 * GIB, gt=0, description="Largest file taken in one upload.")
    max_body_bytes: int = Field(64 * 1024**2, gt=0, description="Largest body of any other request.")
    upload_expiry_hours: float = Field(168.0, gt=0, description="An unfinished upload is dropped after so long a rest.")
    upload_idle_s: float = Field(30.0, gt=0, description="A sender silent for so long frees its upload for another.")
    session_hours: float = Field(336.0, gt=0, description="A login lasts so long.")
    login_attempts: int = Field(10, gt=0, description="Failed logins allowed in fifteen minutes.")
    lease_s: float = Field(30.0, gt=0, description="A stage that doesn't renew its lease for so long runs again.")
    attempts: int = Field(3, gt=0, description="A stage that lost so many workers fails instead of being tried again.")
    redeliver_s: float = Field(2.0, gt=0, description="A waiting job that the queue has forgotten is offered again.")
    event_days: float = Field(30.0, gt=0, description="Steps of jobs and deliveries of webhooks are kept so long.")
    webhook_private: bool = Field(False, description="Let webhooks go to private addresses and over plain http.")
    workers: int = Field(1, ge=0, description="Worker processes that `up` starts.")
    worker_metrics_port: int | None = Field(None, description="Port on which a worker tells its metrics; unset: none.")
    metrics_token: SecretStr | None = Field(None, description="Bearer token for /metrics off loopback.")
    tiles_url: str | None = Field(None, description="Raster tile template for maps; unset: our own plain style.")
    tiles_attribution: str = Field("", description="Whom to thank for the tiles.")
    log_level: str = Field("info", description="Least level that is logged: debug, info, warning, error.")
    log_json: bool = Field(False, description="Log JSON lines instead of readable ones.")

    @property
    def is_loopback(self) -> bool:
        """Whether one person on this machine uses Ponthy, without a login."""
        if self.auth is not None:
            return not self.auth
        return is_loopback_host(self.host)

    @cached_property
    def database(self) -> str:
        """SQLAlchemy URL of the database in use."""
        if self.database_url is None:
            return f"sqlite:///{self.data_dir.resolve() / 'ponthy.sqlite3'}"
        return self.database_url.get_secret_value().replace("postgresql://", "postgresql+psycopg://", 1)

    @cached_property
    def broker(self) -> str:
        """Celery URL of the queue in use."""
        return "filesystem://localhost" if self.broker_url is None else self.broker_url.get_secret_value()

    @property
    def blob_dir(self) -> Path:
        """Folder of the files where no object store is configured."""
        return self.data_dir.resolve() / "files"

    @property
    def staging_dir(self) -> Path:
        """Folder of uploads still being received; always on this machine's disk."""
        return self.data_dir.resolve() / "staging"

    @property
    def queue_dir(self) -> Path:
        """Folder of the embedded queue."""
        return self.data_dir.resolve() / "queue"

    @cached_property
    def code_version(self) -> str:
        """Version of the program together with a fingerprint of its science; part of every result's provenance."""
        return f"{__version__}+{science_fingerprint()}"


def is_loopback_host(host: str) -> bool:
    """Whether a host name or address means this machine only."""
    if host == "localhost":
        return True
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False
