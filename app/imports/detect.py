"""What a file is, from its first bytes and its name."""

from __future__ import annotations

import re
from itertools import islice
from typing import Literal

from app.imports.bundle import looks_like_bundle
from app.imports.csvtext import DELIMITERS
from app.imports.gzipped import MAGIC, peek
from app.imports.streams import TIME_NAMES
from app.science.roads.elevation import COLUMNS

Format = Literal["logger", "signals", "elevation", "car_xml", "unknown"]

_PEEK = 64 * 1024
_IMAGE_ENDINGS = (".dat", ".bin", ".img", ".raw")
_SIGNATURES = (
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"\x89PNG\r\n", "a PNG picture"),
    (b"GIF8", "a GIF picture"),
    (b"RIFF", "a sound, picture or video file (RIFF)"),
    (b"%PDF", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive without tables (Excel, KMZ and Word files are ZIP inside); export CSV"),
    (b"7z\xbc\xaf", "a 7-Zip archive; unpack it first"),
    (b"Rar!", "a RAR archive; unpack it first"),
    (b"BZh", "a bzip2 archive; unpack it, or pack it with gzip"),
    (b"\xfd7zXZ", "an XZ archive; unpack it, or pack it with gzip"),
    (b"\x28\xb5\x2f\xfd", "a Zstandard archive; unpack it, or pack it with gzip"),
    (b"MDF     ", "an MDF measurement file; export it as CSV or Parquet"),
    (b"UnFinMF ", "an unfinished MDF measurement file; export it as CSV or Parquet"),
    (b"LOGG", "a Vector BLF log; export it as CSV or Parquet"),
    (b"MATLAB 5.0 MAT", "a MATLAB file; export its signals as CSV or Parquet"),
    (b"\x89HDF", "an HDF5 file (newer MATLAB files are too); export its signals as CSV or Parquet"),
    (b"SQLite format 3", "an SQLite database"),
    (b"\xd0\xcf\x11\xe0", "an old Office file; export it as CSV"),
    (b"\x7fELF", "a program"),
    (b"MZ", "a Windows program"),
)


def detect_format(head: bytes, filename: str) -> Format:
    """Tell what a file holds.

    Parameters
    ----------
    head : bytes
        Its first bytes, some 64 KB of them; packed files are looked into.
    filename : str
        Its name; a name that ends like a logger image lets a damaged or blank beginning pass as one, for the decoder
        to judge.

    Returns
    -------
    str
        ``logger``, ``signals``, ``elevation``, ``car_xml`` or ``unknown``; `explain_unknown` then says why.
    """
    if head.startswith(MAGIC):
        head = peek(head, _PEEK)
    if head.startswith(b"PAR1") or looks_like_bundle(head):
        return "signals"
    if holds_packets(head):
        return "logger"
    if any(head.startswith(signature) for signature, _ in _SIGNATURES):
        return "unknown"
    text = _as_text(head)
    if text is None:
        return "logger" if filename.lower().endswith(_IMAGE_ENDINGS) and head else "unknown"
    if "<ponthy_config" in text:
        return "car_xml"
    return _kind_of_table(text)


def explain_unknown(head: bytes, filename: str) -> str:
    """Say in a sentence what an unknown file looks like and what would be taken instead."""
    packed = head.startswith(MAGIC)
    if packed:
        head = peek(head, _PEEK)
    wanted = "Ponthy takes a logger image, a table of signals (CSV, packed CSV, Parquet) or a car's XML."
    looks = "Unpacked, this is" if packed else "This is"
    for signature, words in _SIGNATURES:
        if head.startswith(signature):
            return f"{looks} {words}. {wanted}"
    if not head:
        return f"The file is {'damaged' if packed else 'empty'}. {wanted}"
    if not head.strip(b"\x00"):
        return f"The file begins with {len(head)} zero bytes and holds no packet there: a blank logger card? {wanted}"
    text = _as_text(head)
    if text is None:
        return f"{looks} binary data without a packet of the logger in its first {len(head)} bytes. {wanted}"
    return f"{looks} {_kind_of_text(text)}. {wanted}"


def holds_packets(head: bytes) -> bool:
    """Tell whether two sound packets of the logger follow each other.

    A packet is FF, a type from 0 to 5, a length, the message, and the sum modulo 256 from the length on (Sebesta 2010,
    App. C.1.4); the length counts the message and the sum.
    """
    at = head.find(0xFF)
    while 0 <= at < len(head):
        after = _packet_end(head, at)
        if after and (after == len(head) or _packet_end(head, after)):
            return True
        at = head.find(0xFF, at + 1)
    return False


def _packet_end(data: bytes, at: int) -> int:
    """Return where a sound packet that begins here ends; 0 when there is none."""
    if data[at : at + 1] != b"\xff" or at + 4 > len(data) or data[at + 1] > 5:
        return 0
    end = at + 3 + data[at + 2]
    if data[at + 2] < 2 or end > len(data) or sum(data[at + 2 : end - 1]) % 256 != data[end - 1]:
        return 0
    return end


def _as_text(head: bytes) -> str | None:
    """Return the beginning as text, or None when it is binary."""
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return head[: len(head) // 2 * 2].decode("utf-16", "replace")
    if b"\x00" in head or not head:
        return None
    text = head.decode("utf-8", "replace").lstrip("\ufeff")
    odd = sum(1 for character in text[:4096] if character < " " and character not in "\t\r\n")
    return text if odd == 0 else None


def _kind_of_table(text: str) -> Format:
    lines = _meaningful_lines(text, 8)
    delimiter = max(DELIMITERS, key=lines[0].count) if lines else ","
    names = {name.strip().strip('"').lower() for name in lines[0].split(delimiter)} if lines else set()
    if len(names) < 2 or lines[0][0] in "<{[$":
        return "unknown"
    if names.issuperset(COLUMNS[:3]) and not names & set(TIME_NAMES):
        return "elevation"
    rows = [line.split(delimiter) for line in lines[1:] if line.count(delimiter) == lines[0].count(delimiter)]
    numbers = any(_is_number(cell) for row in rows for cell in row)
    return "signals" if numbers or names & set(TIME_NAMES) else "unknown"


def _meaningful_lines(text: str, count: int) -> list[str]:
    """Return the first lines that are neither empty nor a comment nor a spreadsheet's ``sep=``."""
    lines = (line.strip() for line in text.splitlines())
    return list(islice((line for line in lines if line and not line.startswith(("#", "sep="))), count))


def _is_number(cell: str) -> bool:
    return re.fullmatch(r'\s*"?[+-]?\d+([.,]\d*)?([eE][+-]?\d+)?"?\s*', cell) is not None


def _kind_of_text(text: str) -> str:
    begin = "\n".join(_meaningful_lines(text, 20))
    if begin.startswith("<"):
        for mark, words in (("<gpx", "a GPX track"), ("<kml", "a KML file"), ("<html", "a web page")):
            if mark in begin.lower():
                return words
        return "XML, but not of a car (a car's XML begins with <ponthy_config>)"
    if begin.startswith(("{", "[")):
        return "JSON text"
    if begin.startswith("$"):
        return "a list of NMEA sentences"
    return "text without columns (a table has a header and commas, semicolons or tabs)"
