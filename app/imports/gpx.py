"""GPX files: the positions of their tracks, or of their routes where there is no track."""

from __future__ import annotations

from datetime import UTC, datetime
from math import isfinite

import numpy as np
from lxml import etree

from app.science.errors import SignalsError
from app.science.optimal.posing.track import Track

LARGEST_BYTES = 100_000_000
POINTS = ("trkpt", "rtept")


def read_gpx(data: bytes) -> Track:
    """Read the points of all tracks in the order of the file; segments are joined.

    Raises
    ------
    SignalsError
        When it is no GPX file or has no points; `row` is the line of what can't be.
    """
    if len(data) > LARGEST_BYTES:
        raise SignalsError(f"The GPX file has more than {LARGEST_BYTES // 1_000_000} MB; split it.")
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        line = int(error.lineno or 0)
        raise SignalsError(f"Line {line}: this isn't well-formed XML.", line) from error
    if root.getroottree().docinfo.internalDTD is not None:
        raise SignalsError("A document type (<!DOCTYPE …>) is not accepted; delete it.")
    for kind in POINTS:
        nodes = [node for node in root.iter(etree.Element) if etree.QName(node).localname == kind]
        if nodes:
            rows = np.array([_row(node) for node in nodes])
            return Track(*(np.ascontiguousarray(column) for column in rows.T))
    raise SignalsError("The GPX file has no track and no route; its waypoints are no road.")


def _row(node: etree._Element) -> tuple[float, float, float, float]:
    """Return latitude, longitude, height and time of a point."""
    lat, lon = (_number(node, name, node.get(name)) for name in ("lat", "lon"))
    if not (abs(lat) <= 90.0 and abs(lon) <= 180.0):
        line = int(node.sourceline or 0)
        raise SignalsError(f"Line {line}: latitude {lat:g}°, longitude {lon:g}° is no place on Earth.", line)
    alt = time = float("nan")
    for child in node.iterchildren(etree.Element):
        name = etree.QName(child).localname
        if name == "ele" and (child.text or "").strip():
            alt = _number(node, "ele", child.text)
        elif name == "time":
            time = _seconds(child.text or "")
    return lat, lon, alt, time


def _number(node: etree._Element, name: str, text: str | None) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        line = int(node.sourceline or 0)
        raise SignalsError(f"Line {line}: {name} {text!r} is not a number.", line, name)
    return value


def _seconds(text: str) -> float:
    """Return a time as seconds since 1970; NaN where it is none, for only jumps are looked for with it."""
    try:
        stamp = datetime.fromisoformat(text.strip())
    except ValueError:
        return float("nan")
    return (stamp if stamp.tzinfo else stamp.replace(tzinfo=UTC)).timestamp()
