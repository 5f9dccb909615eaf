"""Formulas through a car's map over REST."""

from __future__ import annotations

import csv
import json
from io import StringIO
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.maps.updating import update
from tests.synthetic import drive, points_at, random_points
from tests.yards import Yard, silent

PHI = [9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04]
OBSERVATION = drive(seconds=60.0)


@pytest.fixture
def mapped(yard: Yard) -> Yard:
    """A car whose map is of Table 4.1's engine."""
    yard.observed("one", OBSERVATION, random_points(60_000))
    yard.write(update(yard.resources, FLEET, yard.car_id, silent))
    return yard


def ask(client: TestClient, yard: Yard, rest: str = "", **params: Any) -> Any:
    return client.get(f"/api/v1/cars/{yard.car_id}/maps/latest/fits{rest}", params=params)


def test_the_thesis_table_comes_back_with_its_uncertainty(client: TestClient, mapped: Yard) -> None:
    answer = ask(client, mapped, target="phi", degree=2).json()
    assert (answer["version"], answer["best"]) == (1, "table 4.1")
    (table,) = [one for one in answer["fits"] if one["proposed"]]
    off = np.abs(np.array(table["coefficients"]) - PHI)
    assert (off < 0.02 * np.abs(PHI) + 4.0 * np.array(table["sd"])).all()
    assert table["r_squared"] > 0.999
    assert table["peak"]["rpm"] == pytest.approx(3867.0, abs=100.0)
    assert answer["best_of_all"]["compared"] == 11


def test_own_terms_and_fuel_power(client: TestClient, mapped: Yard) -> None:
    own = ask(client, mapped, target="phi", terms="1,w,T,wT,w2,T2").json()
    assert [one["words"] for one in own["fits"]] == [["1", "ω", "T", "ωT", "ω²", "T²"]]
    fuel = ask(client, mapped, target="p_in", degree=2).json()
    assert "Willans" in [one["name"] for one in fuel["fits"]]
    assert all(one["idle_fuel_power_w"] is not None for one in fuel["fits"])


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_all_figures_of_a_class_together_are_small(client: TestClient, mapped: Yard, theme: str) -> None:
    for degree in (2, 3, 4):
        asked = {"target": "p_in", "degree": degree}
        document = ask(client, mapped, **asked)
        size = len(document.content)
        for one in document.json()["fits"]:
            for name in ("contour", "residuals"):
                drawn = ask(client, mapped, f"/figures/{name}", formula=one["name"], theme=theme, **asked)
                assert drawn.status_code == 200, drawn.text
                size += len(drawn.content)
        size += len(ask(client, mapped, "/figures/load", theme=theme, **asked).content)
        assert size < 300_000


def test_where_to_drive_is_outlined(client: TestClient, mapped: Yard) -> None:
    gaps = ask(client, mapped, remedy="drive", degree=2).json()["gaps"]
    shapes = ask(client, mapped, "/figures/contour", remedy="drive", degree=2).json()["layout"].get("shapes", [])
    assert len(shapes) == len(gaps)


def test_formulas_are_saved_as_json_csv_and_as_an_engine(client: TestClient, mapped: Yard) -> None:
    saved = ask(client, mapped, "/export", target="phi", degree=2)
    assert json.loads(saved.content)["best"] == "table 4.1"
    assert "map 1, phi.json" in saved.headers["content-disposition"]
    rows = list(csv.DictReader(StringIO(ask(client, mapped, "/export", format="csv", degree=2).text)))
    assert {"formula", "coefficient", "sd", "unit"} <= set(rows[0])
    block = ask(client, mapped, "/export", format="engine").json()
    assert block["engine"]["phi"] == pytest.approx(PHI, rel=0.05)
    assert set(block["engine"]) == {"phi", "speed_rpm", "torque_nm", "full_load", "idle_fuel_power_w"}


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"terms": "1,x"}, "'x' is not a term"),
        ({"degree": "5"}, "less than or equal to 4"),
        ({"target": "phi", "remedy": "border"}, "choose the remedy 'cut'"),
        ({"target": "torque"}, "'eta', 'phi' or 'p_in'"),
    ],
)
def test_what_cannot_be_asked_is_refused_in_words(
    client: TestClient, mapped: Yard, params: dict[str, str], words: str
) -> None:
    refused = ask(client, mapped, **params)
    assert refused.status_code == 422
    assert words in refused.json()["detail"]


def test_an_unknown_formula_is_named_with_those_there_are(client: TestClient, mapped: Yard) -> None:
    refused = ask(client, mapped, "/figures/contour", formula="Smart", degree=2)
    assert (refused.status_code, "'table 4.1'" in refused.json()["detail"]) == (422, True)


def test_a_map_of_one_engine_speed_is_refused_with_what_to_do(client: TestClient, yard: Yard) -> None:
    nm = np.linspace(20.0, 100.0, 4000)
    yard.observed("one speed", OBSERVATION, points_at(np.full(4000, 2525.0), nm))
    yard.write(update(yard.resources, FLEET, yard.car_id, silent))
    refused = ask(client, yard)
    assert refused.status_code == 422
    assert "one engine speed" in refused.json()["detail"]
    assert "Drive with others" in refused.json()["detail"]
    assert client.get(f"/api/v1/cars/{yard.car_id}/maps/9/fits").status_code == 404
