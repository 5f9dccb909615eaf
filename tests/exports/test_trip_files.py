"""KMZ, MAT and GeoJSON of a trip, read with independent readers."""

from __future__ import annotations

import io
import json
import re
import zipfile

import matplotlib as mpl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree
from PIL import Image
from scipy.io import loadmat

from app.exports.archive import file_stem, zip_bytes
from app.exports.geojson import trip_geojson
from app.exports.kmz import clock, jet, trip_kmz
from app.exports.mat import trip_mat_zip
from app.exports.track import track
from app.science.errors import TooLittleData
from app.science.logger.recording import Recording, Series
from tests.synthetic import START_UTC_S, drive, sensors_of, with_columns

OBSERVATION = drive(seconds=600.0)
RECORDING = sensors_of(OBSERVATION)
LOST = with_columns(OBSERVATION, lat_deg=np.full(len(OBSERVATION.columns["t_s"]), np.nan))
KML = {"k": "http://www.opengis.net/kml/2.2"}
ORDER = ["name", "visibility", "open", "description", "styleUrl", "Style", "Point", "LineString", "Folder", "Placemark"]


def kml_of(data: bytes) -> etree._Element:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        assert archive.namelist()[0] == "doc.kml"
        return etree.fromstring(archive.read("doc.kml"))


def coordinates(element: etree._Element) -> np.ndarray:
    return np.array([[float(x) for x in point.split(",")] for point in str(element.text).split()])


def test_the_kmz_has_pins_where_the_trip_began_and_ended() -> None:
    kml = kml_of(trip_kmz(OBSERVATION, name="To work"))
    c = OBSERVATION.columns
    for title, at in (("Start", 0), ("Stop", -1)):
        place = kml.xpath(f"//k:Placemark[k:name='{title}']/k:Point/k:coordinates", namespaces=KML)
        lon, lat, alt = coordinates(place[0])[0]
        assert lon == pytest.approx(c["lon_deg"][at], abs=1e-7)
        assert lat == pytest.approx(c["lat_deg"][at], abs=1e-7)
        assert alt == pytest.approx(c["alt_m"][at], abs=6e-3)


def test_the_line_is_unbroken_and_its_colours_are_jet_up_to_180_km_per_hour() -> None:
    kml = kml_of(trip_kmz(OBSERVATION, name="x"))
    lines = kml.xpath("//k:Folder[k:name='Speed']/k:Placemark", namespaces=KML)
    colours = {
        str(style.get("id")): str(style.findtext("k:LineStyle/k:color", namespaces=KML))
        for style in kml.iterfind(".//k:Style", KML)
    }
    total, last = 0, None
    for line in lines:
        vertices = coordinates(line.find("k:LineString/k:coordinates", KML))
        assert last is None or vertices[0].tolist() == last
        last = vertices[-1].tolist()
        total += len(vertices) - 1
        kmh = float(str(line.findtext("k:name", namespaces=KML)).split()[0])
        shown = colours[str(line.findtext("k:styleUrl", namespaces=KML))[1:]]
        red, green, blue = (int(shown[at : at + 2], 16) / 255 for at in (6, 4, 2))
        expected = mpl.colormaps["jet"](kmh / 180.0)
        np.testing.assert_allclose((red, green, blue), expected[:3], atol=0.16)
    assert total == 600
    speeds = [float(str(line.findtext("k:name", namespaces=KML)).split()[0]) for line in lines]
    assert max(speeds) == pytest.approx(3.6 * OBSERVATION.columns["speed_mps"].max(), abs=3.0)


def test_jet_ends_in_dark_blue_and_deep_red() -> None:
    np.testing.assert_allclose(jet(np.array([0.0, 0.5, 1.0])), [[0, 0, 0.5], [0.5, 1, 0.5], [0.5, 0, 0]])


def test_labels_float_along_the_way_and_tell_the_trip_time() -> None:
    kml = kml_of(trip_kmz(OBSERVATION, name="x", started_at_utc_s=START_UTC_S))
    labels = kml.xpath("//k:Folder[k:name='Trip time']/k:Placemark", namespaces=KML)
    assert 20 <= len(labels) <= 60
    c = OBSERVATION.columns
    for label in labels:
        told = str(label.findtext("k:description", namespaces=KML))
        t = float(told.split(" ms")[0]) / 1000.0
        assert str(label.findtext("k:name", namespaces=KML)) == clock(t)
        place = coordinates(label.find("k:Point/k:coordinates", KML))[0]
        assert place[1] == pytest.approx(np.interp(t, c["t_s"], c["lat_deg"]), abs=1e-6)
        assert label.findtext("k:Point/k:altitudeMode", namespaces=KML) == "relativeToGround"
    assert "2009-10-27 07:41:00 UTC" in str(labels[0].findtext("k:description", namespaces=KML))


def test_heights_are_there_but_hidden_at_first() -> None:
    kml = kml_of(trip_kmz(OBSERVATION, name="x"))
    line = kml.xpath("//k:Folder[k:name='Height']/k:Placemark", namespaces=KML)[0]
    assert line.findtext("k:visibility", namespaces=KML) == "0"
    assert line.findtext("k:LineString/k:altitudeMode", namespaces=KML) == "absolute"
    heights = coordinates(line.find("k:LineString/k:coordinates", KML))[:, 2]
    assert heights.max() == pytest.approx(OBSERVATION.columns["alt_m"].max(), abs=0.5)


def test_the_kmz_needs_no_other_host_and_its_icon_is_a_picture() -> None:
    data = trip_kmz(OBSERVATION, name="x")
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        text = archive.read("doc.kml").decode()
        icon = Image.open(io.BytesIO(archive.read("files/box.png"))).convert("RGB")
    assert set(re.findall(r"https?://[^\"<]+", text)) == {"http://www.opengis.net/kml/2.2"}
    assert {str(href) for href in etree.fromstring(text.encode()).xpath("//k:href/text()", namespaces=KML)} == {
        "files/box.png"
    }
    assert icon.size == (16, 16)
    assert icon.getpixel((8, 8)) == (32, 96, 192)


@given(st.text(max_size=30))
def test_any_name_is_escaped_and_children_keep_the_schemas_order(name: str) -> None:
    kml = kml_of(trip_kmz(drive(seconds=5.0), name=name))
    title = str(kml.findtext("k:Document/k:name", namespaces=KML) or "")
    assert title == "".join(c for c in name if c.isprintable())
    for parent in kml.iter("{*}Placemark", "{*}Document", "{*}Folder"):
        order = [ORDER.index(etree.QName(child).localname) for child in parent]
        assert order == sorted(order)
    used = {str(url)[1:] for url in kml.xpath("//k:styleUrl/text()", namespaces=KML)}
    assert used <= {str(style.get("id")) for style in kml.iterfind(".//k:Style", KML)}


def test_without_positions_the_reason_is_said() -> None:
    for write in (trip_kmz, trip_geojson):
        with pytest.raises(TooLittleData, match=r"No position is known.*export it as CSV"):
            write(LOST, name="x")


def test_a_track_is_thinned_in_time_with_both_ends() -> None:
    thin = track(OBSERVATION.columns, 1.0)
    assert len(thin.t_s) == 601
    assert (thin.t_s[0], thin.t_s[-1]) == (0.0, OBSERVATION.columns["t_s"][-1])
    assert np.diff(thin.t_s)[:-1].min() > 0.8


def test_the_mat_files_hold_the_same_numbers() -> None:
    road = Recording({**RECORDING.signals, "road_alt_m": Series(np.array([1.0, 2.0]), np.array([60.0, 61.0]))})
    recording = Recording(road.signals, RECORDING.started_at_utc_s, RECORDING.texts, RECORDING.warnings)
    with zipfile.ZipFile(io.BytesIO(trip_mat_zip(OBSERVATION, recording, name="2009-10-27"))) as archive:
        kinds = ["data.mat", "extract.mat", "results.mat", "DEM.mat", "gps.txt", "spd.kmz"]
        assert archive.namelist() == [f"2009-10-27,{kind}" for kind in kinds]
        files = {kind: archive.read(f"2009-10-27,{kind}") for kind in kinds}
    data, extract, results, dem = (
        loadmat(io.BytesIO(files[kind]), squeeze_me=True, struct_as_record=False) for kind in kinds[:4]
    )
    for name in ("vss_tick", "ax_mps2", "injector_pulse_s"):
        np.testing.assert_array_equal(data[name].t_s, RECORDING[name].t_s)
        np.testing.assert_array_equal(data[name].value, RECORDING[name].value)
    assert data["ax_mps2"].unit == "m/s²"
    assert "lat_deg" not in data
    assert "road_alt_m" not in data
    np.testing.assert_array_equal(extract["lat_deg"].value, RECORDING["lat_deg"].value)
    assert "ax_mps2" not in extract
    for name, values in OBSERVATION.columns.items():
        np.testing.assert_array_equal(results[name], values, err_msg=name)
    assert results["trip"].fuel_l == OBSERVATION.fuel_l
    assert results["trip"].tuning == "default"
    assert dem["road_alt_m"].value.tolist() == [60.0, 61.0]
    assert files["gps.txt"].decode() == RECORDING.texts["nmea"]
    assert kml_of(files["spd.kmz"]) is not None


def test_what_a_trip_lacks_is_left_out_of_the_mat_set() -> None:
    bare = Recording({"vss_tick": RECORDING["vss_tick"]})
    with zipfile.ZipFile(io.BytesIO(trip_mat_zip(LOST, bare, name="a/b"))) as archive:
        assert archive.namelist() == ["a_b,data.mat", "a_b,extract.mat", "a_b,results.mat"]


def test_geojson_goes_along_the_trip() -> None:
    document = json.loads(trip_geojson(OBSERVATION, name="x", started_at_utc_s=START_UTC_S))
    line, start, stop = document["features"]
    c = OBSERVATION.columns
    vertices, t = np.array(line["geometry"]["coordinates"]), line["properties"]["t_s"]
    assert len(vertices) == len(t) == len(line["properties"]["speed_mps"]) == 601
    for column, axis, tolerance in (("lon_deg", 0, 1e-6), ("lat_deg", 1, 1e-6), ("alt_m", 2, 0.01)):
        np.testing.assert_allclose(vertices[:, axis], np.interp(t, c["t_s"], c[column]), atol=tolerance)
    np.testing.assert_allclose(line["properties"]["speed_mps"], np.interp(t, c["t_s"], c["speed_mps"]), atol=1e-3)
    assert line["properties"]["started_at"] == "2009-10-27T07:41:00+00:00"
    assert start["geometry"]["coordinates"] == vertices[0].tolist()
    assert stop["geometry"]["coordinates"] == vertices[-1].tolist()
    west, south, east, north = document["bbox"]
    assert west == vertices[:, 0].min()
    assert (south, east, north) == (vertices[:, 1].min(), vertices[:, 0].max(), vertices[:, 1].max())


def test_the_same_trip_gives_the_same_bytes() -> None:
    assert trip_kmz(OBSERVATION, name="x") == trip_kmz(OBSERVATION, name="x")
    first, second = (trip_mat_zip(OBSERVATION, RECORDING, name="x") for _ in range(2))
    assert first == second
    with zipfile.ZipFile(io.BytesIO(zip_bytes({"a": b"1"}))) as archive:
        assert archive.infolist()[0].date_time == (1980, 1, 1, 0, 0, 0)


@given(st.text(max_size=200))
def test_a_stem_is_a_file_name_everywhere(name: str) -> None:
    stem = file_stem(name)
    assert 0 < len(stem) <= 100
    assert not set(stem) & set('/\\:*?"<>|\0\n')
    assert not stem.startswith(".")
