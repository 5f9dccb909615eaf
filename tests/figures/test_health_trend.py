"""The figure of a quantity over trips: bands of one and two sigma, change points, and where an alert lasted."""

from __future__ import annotations

from app.figures.health_trend import trend_figure
from app.science.health.result import HealthAlert, Trend

TRIPS = ("a", "b", "c", "d")
TREND = Trend(
    quantity="mass",
    title="Mass",
    unit="kg",
    trip_ids=TRIPS,
    names=("one", "two", "three", "four"),
    started_at=(0.0, 86400.0, None, 3 * 86400.0),
    estimate=(0.0, 150.0, 160.0, 10.0),
    sd=(10.0, 20.0, 10.0, 10.0),
    usual=0.0,
    usual_sd=5.0,
    band=30.0,
    change_points=("b", "d"),
    words="",
)
CLEARED = HealthAlert("mass", "b", "c", "d", "d", 2, 155.0, 10.0, "kg", 0.9, "", "", "")
OF_ANOTHER = HealthAlert("drag", "a", "a", "d", None, 4, 20.0, 3.0, "%", 0.9, "", "", "")


def test_bands_reach_one_and_two_standard_deviations_around_each_trip() -> None:
    two_low, two_high, one_low, one_high, _ = (trace["y"] for trace in trend_figure(TREND)["data"])
    assert (two_low, two_high) == ([-20, 110, 140, -10], [20, 190, 180, 30])
    assert (one_low, one_high) == ([-10, 130, 150, 0], [10, 170, 170, 20])


def test_trips_within_an_alert_of_that_quantity_are_squares_until_it_was_cleared() -> None:
    trips = trend_figure(TREND, [CLEARED, OF_ANOTHER])["data"][-1]
    assert trips["marker"]["symbol"] == ["circle", "square", "square", "circle"]
    assert [said[1] for said in trips["customdata"]] == [
        "one, 1 Jan 1970",
        "two, 2 Jan 1970",
        "three",
        "four, 4 Jan 1970",
    ]


def test_the_usual_band_and_both_change_points_are_drawn() -> None:
    layout = trend_figure(TREND)["layout"]
    band, _usual, *changes = layout["shapes"]
    assert (band["y0"], band["y1"]) == (-30.0, 30.0)
    assert [line["x0"] for line in changes] == [1.5, 3.5]
    low, high = layout["yaxis"]["range"]
    assert high == -low > 170.0


def test_a_car_whose_trips_all_say_nothing_is_drawn_empty() -> None:
    nothing = Trend("drag", "Air drag", "%", (), (), (), (), (), 0.0, 2.0, 8.0, (), "")
    assert trend_figure(nothing)["data"][-1]["y"] == []
