"""Whatever stands in a header or at the beginning of a file is understood or refused, and never makes us fail."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import PonthyError
from app.science.errors import ScienceError
from app.uploads import tus
from app.uploads.kinds import HEAD_BYTES, complaint
from app.uploads.models import UploadKind
from tests.uploads.conftest import metadata, signals_table

NAMES = ("upload-length", "upload-offset", "upload-metadata", "upload-checksum", "upload-defer-length", "tus-resumable")
json_texts = st.sampled_from(["{}", "[]", "1", "[" * 9999, '{"signals": {"a": {"signal": "speed_mps", "scale": NaN}}}'])
keys = st.sampled_from(["filename", "kind", "car_id", "mapping", "other"])
values = st.one_of(st.text(max_size=40), st.sampled_from(["trip", "elevation", "0" * 32]), json_texts)


@given(st.dictionaries(st.sampled_from(NAMES), st.text(max_size=60)))
def test_any_headers_are_understood_or_refused(headers: dict[str, str]) -> None:
    for read in (tus.check_version, tus.wish, tus.checksum):
        try:
            read(headers)
        except PonthyError as error:
            assert 400 <= error.status < 500  # noqa: PT017 - not raising is fine too


@given(st.dictionaries(keys, values))
def test_any_metadata_are_understood_or_refused(about: dict[str, str]) -> None:
    try:
        wanted = tus.wish({"upload-length": "5", "upload-metadata": metadata(**about)})
    except (PonthyError, ScienceError):
        return
    assert wanted.size == 5
    assert wanted.filename
    assert "/" not in wanted.filename
    assert wanted.filename.isprintable()
    assert (wanted.car_id is None) == (wanted.kind is UploadKind.ELEVATION)


@given(st.dictionaries(st.from_regex("[a-z_]{1,12}", fullmatch=True), st.text(max_size=30)))
def test_metadata_come_back(about: dict[str, str]) -> None:
    assert tus.parse_metadata(tus.write_metadata(about)) == about


@given(st.binary(max_size=600), st.text(max_size=20), st.sampled_from(UploadKind))
def test_any_beginning_is_judged(head: bytes, filename: str, kind: UploadKind) -> None:
    error = complaint(head, len(head), filename, kind)
    assert error is None or error.status == 422


@pytest.mark.parametrize(
    ("head", "kind", "fine"),
    [
        (signals_table(HEAD_BYTES), UploadKind.TRIP, True),
        (signals_table(HEAD_BYTES), UploadKind.ELEVATION, True),  # a table; which columns it lacks its reader tells
        (b"lat_deg,lon_deg,alt_m\n49,8,100\n", UploadKind.ELEVATION, True),
        (b"lat_deg,lon_deg,alt_m\n49,8,100\n", UploadKind.TRIP, False),
        (b"<ponthy_config/>", UploadKind.TRIP, False),
        (b"\xff\x00\x03ab\xc6" * 40, UploadKind.ELEVATION, False),
        (b"PK\x03\x04" + bytes(100), UploadKind.TRIP, False),
    ],
)
def test_kinds_are_told_apart(head: bytes, kind: UploadKind, fine: bool) -> None:
    assert (complaint(head, len(head), "file", kind) is None) == fine
