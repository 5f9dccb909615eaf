"""Batteries over REST: made, configured, looked at, fed with data, removed."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Response

from app.batteries import curve_drawing, data_routes, laboratory_routes, report_routes, result_routes, service
from app.batteries.schemas import CONFIG_EXAMPLE, BatteryChange, BatteryView, NewBattery
from app.edge import API, ReadSession, WriteSession
from app.jobs.service import JobView
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing

batteries = APIRouter(prefix="/batteries", tags=["batteries"])
router = APIRouter()

CONFIG: dict[str, Any] = {
    "requestBody": {"content": {"application/json": {"schema": {"type": "object"}, "example": CONFIG_EXAMPLE}}}
}


@batteries.post("", status_code=201)
def make_battery(session: WriteSession, body: NewBattery, response: Response) -> BatteryView:
    """Give a car a battery: the configuration becomes the `<battery>` of its XML, as a new revision."""
    made = service.create(session, body)
    response.headers["Location"] = f"{API}/batteries/{made.id}"
    return made


@batteries.get("")
def list_batteries(
    session: ReadSession,
    car_id: Annotated[str | None, Query(max_length=32)] = None,
    cursor: Cursor = None,
    limit: Limit = DEFAULT_LIMIT,
) -> Listing[BatteryView]:
    """List batteries, newest first, of one car or of all, each with its latest estimate."""
    return service.page(session, car_id=car_id, cursor=cursor, limit=limit)


@batteries.get("/{battery_id}")
def show_battery(session: ReadSession, battery_id: Id) -> BatteryView:
    """Show a battery: what is in it, what is left of it, and what its car's XML lacks."""
    return service.get(session, battery_id)


@batteries.patch("/{battery_id}")
def change_battery(session: WriteSession, battery_id: Id, body: BatteryChange) -> BatteryView:
    """Write another name or end of life into the car's XML."""
    return service.change(session, battery_id, body)


@batteries.delete("/{battery_id}", status_code=204)
def delete_battery(session: WriteSession, battery_id: Id) -> None:
    """Remove a battery with its data and history, and take it out of its car's XML; what is under way is stopped."""
    service.delete(session, battery_id)


@batteries.get("/{battery_id}/config")
def show_config(session: ReadSession, battery_id: Id) -> dict[str, Any]:
    """Give the configuration as `./ponthy battery --config` takes it, as the car's XML says it."""
    return service.config(session, battery_id)


@batteries.put("/{battery_id}/config", openapi_extra=CONFIG)
def replace_config(session: WriteSession, battery_id: Id, body: dict[str, Any]) -> dict[str, Any]:
    """Put another configuration in force, as a new revision of the car's XML; estimates stay until made again."""
    return service.replace_config(session, battery_id, body)


@batteries.post("/{battery_id}/reestimate", status_code=202)
def estimate_again(session: WriteSession, battery_id: Id) -> JobView:
    """Estimate from all trips and files again, in the order of time, with the configuration and program as they are."""
    return service.estimate_again(session, battery_id)


of_sources = (data_routes.receiving, data_routes.router, laboratory_routes.router)
for part in (curve_drawing.router, report_routes.router, batteries, *of_sources, result_routes.router):
    router.include_router(part)
