"""A trip for Google Earth (Sebesta 2010, App. F)."""

from __future__ import annotations

import struct
import zlib
from datetime import UTC, datetime
from itertools import pairwise
from typing import Any

import numpy as np
from lxml import etree

from app.exports.archive import zip_bytes
from app.exports.track import Track, track
from app.science.arrays import FloatArray, IntArray
from app.science.observer.result import Observation

NAMESPACE = "http://www.opengis.net/kml/2.2"
STEP_S = 1.0
FULL_SCALE_KMH = 180.0
COLOURS = 36
MOST_LABELS = 60
LABEL_STEPS_S = (10, 30, 60, 120, 300, 600, 900, 1800, 3600)
LABEL_HEIGHT_M = 30  # trip times float this high above the road
BOX = "files/box.png"
BOX_BLUE = (32, 96, 192)


def trip_kmz(observation: Observation, *, name: str, started_at_utc_s: float | None = None) -> bytes:
    """Write the trip as a KMZ file that needs nothing from any other host.

    It has pins at start and stop, the way coloured by speed like MATLAB's "jet" normalised to 180 km/h, blue boxes
    that float over the way and tell the trip time, and, hidden at first, the way at its estimated height.

    Parameters
    ----------
    observation : Observation
    name : str
        Of the trip.
    started_at_utc_s : float, optional
        Seconds since 1970-01-01 at time zero; the boxes then also tell the time of day.

    Raises
    ------
    TooLittleData
        When no position is known.
    """
    way = track(observation.columns, STEP_S)
    kml = etree.Element("kml", nsmap={None: NAMESPACE})
    document = _add(kml, "Document")
    _add(document, "name", name)
    _add(document, "description", _in_words(observation))
    _styles(document)
    _ends(_folder(document, "Start and stop"), way)
    _speed_line(_folder(document, "Speed"), way)
    _time_labels(_folder(document, "Trip time"), way, started_at_utc_s)
    _height_line(_folder(document, "Height"), way)
    text = etree.tostring(kml, xml_declaration=True, encoding="UTF-8", pretty_print=True)
    return zip_bytes({"doc.kml": text, BOX: _square_png(16, BOX_BLUE)})


def jet(share: FloatArray) -> FloatArray:
    """Colours of MATLAB's "jet", dark blue to deep red.

    Parameters
    ----------
    share : array, shape (n,)
        0 to 1.

    Returns
    -------
    array, shape (n, 3)
        Red, green and blue, 0 to 1.
    """
    centres = np.array([3.0, 2.0, 1.0])
    return np.asarray(np.clip(1.5 - np.abs(4.0 * share[:, np.newaxis] - centres), 0.0, 1.0))


def _styles(document: Any) -> None:
    shares = (np.arange(COLOURS) + 0.5) / COLOURS
    for number, rgb in enumerate((255.0 * jet(shares)).round().astype(int).tolist()):
        style = _add(document, "Style", id=f"speed-{number}")
        line = _add(style, "LineStyle")
        _add(line, "color", _colour(*rgb))
        _add(line, "width", "5")
    for pin, rgb in (("start", (60, 200, 80)), ("stop", (220, 60, 50))):
        _add(_add(_add(document, "Style", id=pin), "IconStyle"), "color", _colour(*rgb))
    label = _add(document, "Style", id="time")
    icon = _add(label, "IconStyle")
    _add(icon, "scale", "0.5")
    _add(_add(icon, "Icon"), "href", BOX)
    _add(_add(label, "LabelStyle"), "scale", "0.8")
    height = _add(document, "Style", id="height")
    _add(_add(height, "LineStyle"), "color", _colour(*BOX_BLUE))
    _add(_add(height, "PolyStyle"), "color", _colour(*BOX_BLUE, opacity=90))


def _ends(folder: Any, way: Track) -> None:
    for at, title, style in ((0, "Start", "start"), (-1, "Stop", "stop")):
        placemark = _placemark(folder, title, style, f"{clock(way.t_s[at])} since the start")
        _add(_add(placemark, "Point"), "coordinates", _coordinates(way, np.array([at])))


def _speed_line(folder: Any, way: Track) -> None:
    """Draw one line per stretch of the same colour; neighbours share their vertex."""
    kmh = 1.8 * np.abs(way.speed_mps[1:] + way.speed_mps[:-1])
    colour = np.clip(kmh / FULL_SCALE_KMH * COLOURS, 0, COLOURS - 1).astype(np.int64)
    edges = np.concatenate(([0], np.flatnonzero(np.diff(colour)) + 1, [len(colour)]))
    for start, stop in pairwise(edges.tolist()):
        placemark = _placemark(folder, f"{kmh[start:stop].mean():.0f} km/h", f"speed-{colour[start]}")
        line = _add(placemark, "LineString")
        _add(line, "tessellate", "1")
        _add(line, "coordinates", _coordinates(way, np.arange(start, stop + 1)))


def _time_labels(folder: Any, way: Track, started_at_utc_s: float | None) -> None:
    duration = float(way.t_s[-1] - way.t_s[0])
    step = next((s for s in LABEL_STEPS_S if duration / s <= MOST_LABELS), duration / MOST_LABELS)
    times = np.arange(np.ceil(way.t_s[0] / step) * step, way.t_s[-1], step)
    for at in np.unique(np.searchsorted(way.t_s, times)).tolist():
        t = float(way.t_s[at])
        kmh = abs(3.6 * float(way.speed_mps[at]))
        told = f"{1000.0 * t:.0f} ms since the start, {kmh:.0f} km/h, {way.alt_m[at]:.0f} m"
        if started_at_utc_s is not None:
            told += datetime.fromtimestamp(started_at_utc_s + t, UTC).strftime(", %Y-%m-%d %H:%M:%S UTC")
        placemark = _placemark(folder, clock(t), "time", told)
        point = _add(placemark, "Point")
        _add(point, "extrude", "1")
        _add(point, "altitudeMode", "relativeToGround")
        _add(point, "coordinates", f"{way.lon_deg[at]:.7f},{way.lat_deg[at]:.7f},{LABEL_HEIGHT_M}")


def _height_line(folder: Any, way: Track) -> None:
    placemark = _placemark(folder, "Way at its estimated height", "height", hidden=True)
    line = _add(placemark, "LineString")
    _add(line, "extrude", "1")
    _add(line, "altitudeMode", "absolute")
    _add(line, "coordinates", _coordinates(way, np.arange(len(way.t_s))))


def clock(t_s: float) -> str:
    """Return a time since the start as h:mm:ss."""
    minutes, seconds = divmod(int(t_s), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{seconds:02d}"


def _in_words(observation: Observation) -> str:
    words = [f"{observation.duration_s / 60.0:.0f} min"]
    if np.isfinite(observation.distance_m):
        words.append(f"{observation.distance_m / 1000.0:.1f} km")
    if np.isfinite(observation.fuel_l):
        words.append(f"{observation.fuel_l:.2f} l of fuel")
    return f"{', '.join(words)}. Colours: 0 to {FULL_SCALE_KMH:.0f} km/h, dark blue to deep red."


def _folder(document: Any, title: str) -> Any:
    folder = _add(document, "Folder")
    _add(folder, "name", title)
    return folder


def _placemark(folder: Any, title: str, style: str, description: str = "", hidden: bool = False) -> Any:
    """Add a placemark; its children stand in the order that the schema asks for."""
    placemark = _add(folder, "Placemark")
    _add(placemark, "name", title)
    if hidden:
        _add(placemark, "visibility", "0")
    if description:
        _add(placemark, "description", description)
    _add(placemark, "styleUrl", f"#{style}")
    return placemark


def _add(parent: Any, tag: str, text: str | None = None, **attributes: str) -> Any:
    child = etree.SubElement(parent, tag, attributes)
    if text is not None:
        child.text = "".join(c for c in text if c.isprintable())  # XML has no control characters
    return child


def _coordinates(way: Track, indices: IntArray) -> str:
    return " ".join(
        f"{lon:.7f},{lat:.7f},{alt:.2f}"
        for lon, lat, alt in zip(way.lon_deg[indices], way.lat_deg[indices], way.alt_m[indices], strict=True)
    )


def _colour(red: int, green: int, blue: int, opacity: int = 255) -> str:
    """Return a colour in KML's order."""
    return f"{opacity:02x}{blue:02x}{green:02x}{red:02x}"


def _square_png(side: int, rgb: tuple[int, int, int]) -> bytes:
    """Draw a square of one colour."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    rows = (b"\x00" + bytes(rgb) * side) * side
    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
