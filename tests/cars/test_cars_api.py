"""Cars over REST: made from an XML or filled in by a form, every version of the XML kept."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

XML = "application/xml"
ROADSTER = b"""<?xml version="1.0" encoding="UTF-8"?>
<ponthy_config>
  <!-- the grey one -->
  <car><make make="Smart"/><model model="Roadster"/><year year="2004"/></car>
  <mass wet="844kg"/>
  <drag><aero Cd="0.39"/></drag>
  <radio volume="11"/>
</ponthy_config>
"""


def make(client: TestClient, xml: bytes = ROADSTER) -> dict[str, Any]:
    answer = client.post("/api/v1/cars", content=xml, headers={"Content-Type": XML})
    assert answer.status_code == 201, answer.text
    car: dict[str, Any] = answer.json()
    assert answer.headers["Location"] == f"/api/v1/cars/{car['id']}"
    return car


def put_config(client: TestClient, car: dict[str, Any], xml: bytes) -> Any:
    return client.put(f"/api/v1/cars/{car['id']}/config", content=xml, headers={"Content-Type": XML})


def test_a_car_is_made_from_its_xml(client: TestClient) -> None:
    car = make(client)
    assert car["name"] == car["title"] == "Smart Roadster 2004"
    assert car["vehicle"]["mass_kg"] == 844 + 75
    assert car["vehicle"]["cd"] == 0.39
    assert car["unknown"] == ["radio@volume"]
    assert "inj/lps@lps" not in car["warnings"]
    assert (car["trip_count"], car["litres_per_100km"], car["latest_map"]) == (0, None, None)
    assert client.get(f"/api/v1/cars/{car['id']}").json() == car


def test_a_car_is_made_from_json(client: TestClient) -> None:
    named = client.post("/api/v1/cars", json={"name": "Grey", "config_xml": ROADSTER.decode()}).json()
    assert (named["name"], named["title"]) == ("Grey", "Smart Roadster 2004")
    assert named["config_sha256"] == make(client)["config_sha256"]
    empty = client.post("/api/v1/cars").json()
    assert empty["title"] == "Unnamed car"
    assert empty["vehicle"]["wheel_radius_m"] == pytest.approx(0.2954, abs=1e-4)


@pytest.mark.parametrize(
    ("xml", "line", "element"),
    [
        (b"<ponthy_config>\n\n<mass wet='heavy'/></ponthy_config>", 3, "ponthy_config/mass"),
        (b"<ponthy_config>\n<drag><aero Cd='-1'/></drag></ponthy_config>", 2, "ponthy_config/drag/aero"),
        (b"<ponthy_config>\n<mass", 2, ""),
        (b'<!DOCTYPE x [<!ENTITY a "b">]>\n<ponthy_config>&a;</ponthy_config>', 1, ""),
        (b"", 0, ""),
        (b"\x00\x01\x02", 1, ""),
    ],
)
def test_a_bad_xml_is_answered_with_its_place(client: TestClient, xml: bytes, line: int, element: str) -> None:
    answer = client.post("/api/v1/cars", content=xml, headers={"Content-Type": XML})
    problem = answer.json()
    assert (answer.status_code, problem["code"]) == (422, "bad-car-xml")
    assert problem["element"] == element
    assert problem["line"] in (line, 0) if not element else problem["line"] == line
    car = make(client)
    assert put_config(client, car, xml).json()["detail"] == problem["detail"]
    assert client.get(f"/api/v1/cars/{car['id']}/config").content == ROADSTER


def test_the_xml_comes_out_as_it_went_in(client: TestClient) -> None:
    car = make(client)
    answer = client.get(f"/api/v1/cars/{car['id']}/config")
    assert answer.content == ROADSTER
    assert answer.headers["Content-Type"].startswith(XML)


def test_every_version_of_the_xml_is_kept(client: TestClient) -> None:
    car = make(client)
    lighter = ROADSTER.replace(b"844kg", b"800kg")
    changed = put_config(client, car, lighter).json()
    assert changed["vehicle"]["mass_kg"] == 875
    assert (changed["config_revision"], changed["config_sha256"] == car["config_sha256"]) == (2, False)
    assert put_config(client, car, lighter).json()["config_revision"] == 2
    url = f"/api/v1/cars/{car['id']}/config"
    listed = client.get(f"{url}/revisions").json()["items"]
    assert [revision["number"] for revision in listed] == [2, 1]
    assert client.get(url, params={"revision": 1}).content == ROADSTER
    assert client.get(url).content == lighter
    assert client.get(url, params={"revision": 3}).status_code == 404


def test_files_that_mean_the_same_have_the_same_fingerprint(client: TestClient) -> None:
    car = make(client)
    spaced = ROADSTER.replace(b"<!-- the grey one -->", b"<!-- grey -->\n\n")
    changed = put_config(client, car, spaced).json()
    assert changed["config_sha256"] == car["config_sha256"]
    assert changed["config_revision"] == 2


def test_the_form_changes_a_value_and_nothing_else(client: TestClient) -> None:
    car = make(client)
    url = f"/api/v1/cars/{car['id']}/config/form"
    fields = {field["path"]: field for field in client.get(url).json()["fields"]}
    assert fields["drag/aero@Cd"]["value"] == 0.39
    assert {"label", "unit", "help", "kind", "minimum", "maximum", "group"} <= set(fields["drag/aero@Cd"])
    after = client.put(url, json={"values": {"drag/aero@Cd": 0.35}}).json()
    assert {field["path"]: field["value"] for field in after["fields"]}["drag/aero@Cd"] == 0.35
    xml = client.get(f"/api/v1/cars/{car['id']}/config").content
    assert xml == ROADSTER.replace(b'"0.39"', b'"0.35"')


def test_a_bad_form_names_each_field(client: TestClient) -> None:
    car = make(client)
    values = {"drag/aero@Cd": 35, "nothing@x": 1, "mass@wet": "heavy"}
    answer = client.put(f"/api/v1/cars/{car['id']}/config/form", json={"values": values})
    assert (answer.status_code, answer.json()["code"]) == (422, "bad-car-form")
    assert set(answer.json()["fields"]) == set(values)
    assert client.get(f"/api/v1/cars/{car['id']}/config").content == ROADSTER


def test_a_car_is_renamed_and_loaded(client: TestClient) -> None:
    car = make(client)
    url = f"/api/v1/cars/{car['id']}"
    assert client.patch(url, json={"name": " Grey "}).json()["name"] == "Grey"
    loaded = client.patch(url, json={"load_kg": 200}).json()
    assert (loaded["name"], loaded["vehicle"]["mass_kg"]) == ("Grey", 1044)


@pytest.mark.parametrize(
    "body", [{"name": ""}, {"name": "a\nb"}, {"name": "x" * 201}, {"load_kg": -1}, {"colour": "red"}]
)
def test_an_impossible_change_is_refused(client: TestClient, body: dict[str, Any]) -> None:
    answer = client.patch(f"/api/v1/cars/{make(client)['id']}", json=body)
    assert answer.status_code == 422
    assert answer.json()["field"] == f"body.{next(iter(body))}"


def test_cars_are_listed_by_page(client: TestClient) -> None:
    ids = [make(client)["id"] for _ in range(3)]
    first = client.get("/api/v1/cars", params={"limit": 2}).json()
    rest = client.get("/api/v1/cars", params={"limit": 2, "cursor": first["next_cursor"]}).json()
    assert [car["id"] for car in first["items"] + rest["items"]] == ids[::-1]
    assert rest["next_cursor"] is None


def test_a_car_without_trips_is_removed(client: TestClient) -> None:
    car = make(client)
    assert client.delete(f"/api/v1/cars/{car['id']}").status_code == 204
    assert client.get(f"/api/v1/cars/{car['id']}").status_code == 404


def test_a_car_with_trips_is_removed_on_purpose_only(client: TestClient) -> None:
    car = make(client)
    params = {"car_id": car["id"], "filename": "a.csv"}
    trip = client.post("/api/v1/trips", params=params, content=b"t_s,speed_mps\n0,1\n1,2\n").json()["trip"]
    assert client.get(f"/api/v1/cars/{car['id']}").json()["trip_count"] == 1
    answer = client.delete(f"/api/v1/cars/{car['id']}")
    assert (answer.status_code, answer.json()["code"]) == (409, "car-has-trips")
    assert client.delete(f"/api/v1/cars/{car['id']}", params={"with_trips": True}).status_code == 204
    assert client.get(f"/api/v1/trips/{trip['id']}").status_code == 404


def test_another_media_type_is_refused(client: TestClient) -> None:
    answer = client.post("/api/v1/cars", content=b"x", headers={"Content-Type": "text/plain"})
    assert answer.status_code == 415


def test_a_very_long_xml_is_refused(client: TestClient) -> None:
    long = b"<ponthy_config>" + b" " * 2_000_000 + b"</ponthy_config>"
    answer = client.post("/api/v1/cars", content=long, headers={"Content-Type": XML})
    assert (answer.status_code, answer.headers["Content-Type"]) == (413, "application/problem+json")
