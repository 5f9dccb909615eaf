"""What a file is that turns out to be no logger image."""

from __future__ import annotations

SIGNATURES = (
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"\x89PNG", "a PNG picture"),
    (b"GIF8", "a GIF picture"),
    (b"%PDF", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive (or an office document or KMZ, which are ZIP archives); unpack it first"),
    (b"\x1f\x8b", "a gzip archive; unpack it first"),
    (b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive; unpack it first"),
    (b"Rar!", "a RAR archive; unpack it first"),
    (b"PAR1", "a Parquet table; import it as signals"),
    (b"MDF ", "an MDF measurement file; import it as such"),
    (b"UnFinMF", "an MDF measurement file that was never finished; import it as such"),
    (b"SQLite format 3", "an SQLite database"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"\x89HDF", "an HDF5 or MATLAB file"),
    (b"\x7fELF", "a program"),
    (b"MZ", "a Windows program"),
    (b"RIFF", "a sound or video file"),
    (b"<?xml", "an XML text"),
    (b"<ponthy_config", "a car's XML; add it to the car instead"),
    (b"$GP", "receiver text (NMEA) without the logger's packets"),
    (b"$GN", "receiver text (NMEA) without the logger's packets"),
)
MOST_CONTROL = 0.02


def looks_like(head: bytes) -> str:
    """Name the kind of file that begins with these bytes, as far as it can be told.

    Parameters
    ----------
    head : bytes
        The first kilobyte or so.

    Returns
    -------
    str
        For example ``a JPEG picture``; empty when nothing fits.
    """
    for signature, name in SIGNATURES:
        if head.startswith(signature):
            return name
    if head[4:8] == b"ftyp":
        return "a film"
    if head and is_text(head):
        return f"text beginning with {head[:40].decode('utf-8', 'replace').splitlines()[0]!r}"
    return ""


def is_text(head: bytes) -> bool:
    """Tell whether bytes read as a person's text."""
    control = sum(byte < 32 and byte not in b"\t\r\n\f" for byte in head)
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as error:
        if error.start < len(head) - 4:
            return False
    return control <= MOST_CONTROL * len(head)
