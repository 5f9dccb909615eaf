"""What a process of the service holds open: settings, database, files, queue."""

from __future__ import annotations

from dataclasses import dataclass

from app.settings import Settings
from app.storage.blobs import Blobs
from app.storage.database import Database
from app.storage.queue import Queue


@dataclass(frozen=True, slots=True)
class Resources:
    """Opened once by the web application, by each worker and by each command that needs the service's data."""

    settings: Settings
    database: Database
    blobs: Blobs
    queue: Queue

    @classmethod
    def open(cls, settings: Settings) -> Resources:
        """Open everything the settings name; the folders are made when they are missing."""
        settings.data_dir.mkdir(parents=True, exist_ok=True)
        settings.staging_dir.mkdir(parents=True, exist_ok=True)
        queue = Queue(settings)
        return cls(
            settings=settings,
            database=Database(settings.database, queue.send),
            blobs=Blobs(settings.blob_dir, settings.blob_url, settings.s3_endpoint),
            queue=queue,
        )

    def close(self) -> None:
        """Close what was opened."""
        self.database.close()
        self.queue.close()
