"""The words of tus 1.0 (https://tus.io/protocols/resumable-upload): headers in, headers out."""

from __future__ import annotations

import base64
import binascii
import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from email.utils import format_datetime
from typing import Any

from app.errors import PonthyError
from app.imports.mapping import SignalMapping
from app.uploads.models import UploadKind

VERSION = "1.0.0"
EXTENSIONS = "creation,creation-with-upload,checksum,termination,expiration"
ALGORITHMS = ("sha1", "sha256")
BODY_TYPE = "application/offset+octet-stream"
CHECKSUM_MISMATCH = 460
LONGEST_FILENAME = 255


class BadTusRequest(PonthyError):  # noqa: N818 - reads as the condition it names
    """A header of the protocol is missing or makes no sense."""

    def __init__(self, header: str, message: str, status: int = 400) -> None:
        super().__init__("bad-tus-request", f"{header}: {message}", status, field=header)


@dataclass(frozen=True, slots=True)
class Checksum:
    """What the bytes of one request must hash to."""

    algorithm: str
    digest: bytes

    def new_hash(self) -> hashlib._Hash:
        """Return an empty hash of the algorithm."""
        return hashlib.new(self.algorithm, usedforsecurity=False)


@dataclass(frozen=True, slots=True)
class Wish:
    """What a new upload is to be."""

    size: int
    filename: str
    kind: UploadKind
    car_id: str | None
    mapping: dict[str, Any] | None


def check_version(headers: Mapping[str, str]) -> None:
    """Refuse another version of the protocol."""
    if headers.get("tus-resumable") != VERSION:
        message = f"send {VERSION}, the version of tus spoken here"
        error = BadTusRequest("Tus-Resumable", message, 412)
        error.headers["Tus-Version"] = VERSION
        raise error


def whole_number(headers: Mapping[str, str], name: str) -> int:
    """Return the value of a header that counts bytes."""
    text = headers.get(name.lower(), "")
    if not re.fullmatch(r"[0-9]{1,18}", text):
        raise BadTusRequest(name, f"{text!r} is not a number of bytes" if text else "this header is missing")
    return int(text)


def wish(headers: Mapping[str, str]) -> Wish:
    """Return what the headers of a creation ask for."""
    if "upload-defer-length" in headers and "upload-length" not in headers:
        raise BadTusRequest("Upload-Defer-Length", "the length must be known; send Upload-Length")
    size = whole_number(headers, "Upload-Length")
    metadata = parse_metadata(headers.get("upload-metadata", ""))
    return make_wish(size, metadata)


def make_wish(size: int, metadata: Mapping[str, str]) -> Wish:
    """Return what an upload's metadata ask for."""
    try:
        kind = UploadKind(metadata.get("kind") or UploadKind.TRIP)
    except ValueError as error:
        raise BadTusRequest("Upload-Metadata", f"kind {metadata['kind']!r} is neither trip nor elevation") from error
    car_id = metadata.get("car_id") or None
    if kind is UploadKind.TRIP and not re.fullmatch("[0-9a-f]{32}", car_id or ""):
        raise BadTusRequest("Upload-Metadata", "car_id must name the car the trip was driven with", 422)
    mapping = _mapping(metadata["mapping"]) if metadata.get("mapping") else None
    is_trip = kind is UploadKind.TRIP
    return Wish(size, clean_filename(metadata.get("filename", "")), kind, car_id if is_trip else None, mapping)


def _mapping(text: str) -> dict[str, Any]:
    try:
        mapping: dict[str, Any] = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise BadTusRequest("Upload-Metadata", f"mapping is not JSON: {error}", 422) from error
    SignalMapping.from_dict(mapping)  # refuses, with the place, what could not be used once all bytes are here
    return mapping


def parse_metadata(header: str) -> dict[str, str]:
    """Return the keys and values of an ``Upload-Metadata`` header."""
    metadata = {}
    for pair in filter(None, (part.strip() for part in header.split(","))):
        key, _, value = pair.partition(" ")
        try:
            metadata[key] = base64.b64decode(value.strip(), validate=True).decode()
        except (binascii.Error, UnicodeDecodeError) as error:
            raise BadTusRequest("Upload-Metadata", f"the value of {key!r} is not base64 of UTF-8 text") from error
    return metadata


def write_metadata(metadata: Mapping[str, str]) -> str:
    """Return keys and values as an ``Upload-Metadata`` header."""
    return ",".join(f"{key} {base64.b64encode(value.encode()).decode()}" for key, value in metadata.items())


def clean_filename(name: str) -> str:
    """Return a file's name without folders and control characters, never empty."""
    last = re.split(r"[/\\]", name)[-1]
    return "".join(letter for letter in last if letter.isprintable()).strip()[-LONGEST_FILENAME:] or "upload"


def checksum(headers: Mapping[str, str]) -> Checksum | None:
    """Return what an ``Upload-Checksum`` header asks for, where there is one."""
    header = headers.get("upload-checksum")
    if header is None:
        return None
    algorithm, _, value = header.partition(" ")
    if algorithm not in ALGORITHMS:
        raise BadTusRequest("Upload-Checksum", f"{algorithm!r} is not known here; use {' or '.join(ALGORITHMS)}")
    try:
        return Checksum(algorithm, base64.b64decode(value.strip(), validate=True))
    except binascii.Error as error:
        raise BadTusRequest("Upload-Checksum", "the value is not base64") from error


def expires(moment: datetime) -> str:
    """Return a moment as the ``Upload-Expires`` header writes it."""
    return format_datetime(moment, usegmt=True)
