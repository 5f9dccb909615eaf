"""The way to the queue: one description of the broker for senders and workers, and sending a task by its name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from celery import Celery

from app.settings import Settings
from app.storage.outbox import Message

VISIBILITY_TIMEOUT_S = 6 * 3600
"""Redis gives an unacknowledged message to another worker after this; longer than the longest task."""
MAIN_QUEUE = "celery"
"""Name of the one queue; Celery's own default."""


def broker_configuration(settings: Settings) -> dict[str, Any]:
    """Return Celery's configuration of the broker; the same for whoever sends and whoever works."""
    if settings.broker.startswith("filesystem://"):
        return {"broker_url": settings.broker, "broker_transport_options": _folders(settings.queue_dir)}
    options = {
        "visibility_timeout": VISIBILITY_TIMEOUT_S,
        "unacked_restore_interval": 1,
        "unacked_restore_throttle": 1,
        "socket_timeout": 10,
        "socket_connect_timeout": 5,
    }
    return {"broker_url": settings.broker, "broker_transport_options": options}


def _folders(base: Path) -> dict[str, Any]:
    # Sender and receiver use the same folder for messages; a file there is a message.
    for name in ("messages", "processed", "control"):
        (base / name).mkdir(parents=True, exist_ok=True)
    return {
        "data_folder_in": str(base / "messages"),
        "data_folder_out": str(base / "messages"),
        "processed_folder": str(base / "processed"),
        "control_folder": str(base / "control"),
        "store_processed": False,
        "polling_interval": 0.1,
    }


class Queue:
    """Sends tasks by name; it knows nothing of what they do."""

    def __init__(self, settings: Settings) -> None:
        self._celery = Celery("ponthy", set_as_current=False)
        self._celery.conf.update(
            broker_configuration(settings),
            task_ignore_result=True,
            broker_connection_retry_on_startup=False,
            task_publish_retry_policy={"max_retries": 1, "interval_start": 0.1},
        )

    def send(self, message: Message) -> None:
        """Hand a message to the broker; raises when the broker doesn't take it."""
        self._celery.send_task(message.task, kwargs=message.kwargs)

    def check(self) -> None:
        """Raise when the broker doesn't answer."""
        with self._celery.connection_for_write() as connection:
            connection.ensure_connection(max_retries=1, timeout=5)

    def size(self) -> int:
        """Return how many messages wait for a worker."""
        with self._celery.connection_for_read() as connection, connection.SimpleQueue(MAIN_QUEUE) as queue:
            try:
                return int(queue.qsize())
            except connection.channel_errors:  # Redis has no such thing as an empty list
                return 0

    def close(self) -> None:
        """Close the connections to the broker."""
        self._celery.close()
