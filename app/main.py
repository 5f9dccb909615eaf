"""The web application: every slice's routes and pages behind one edge."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI

from app import __version__, pages, probes, problems, tables
from app.accounts import pages as account_pages
from app.accounts import routes as account_routes
from app.accounts import service as accounts
from app.batteries import pages as battery_pages
from app.batteries import routes as battery_routes
from app.cars import calibration_routes as car_calibration_routes
from app.cars import pages as car_pages
from app.cars import routes as car_routes
from app.drives import pages as drive_pages
from app.drives import routes as drive_routes
from app.eco import pages as eco_pages
from app.eco import routes as eco_routes
from app.edge import API
from app.health import routes as health_routes
from app.jobs import pages as job_pages
from app.jobs import routes as job_routes
from app.maps import fit_routes as map_fit_routes
from app.maps import pages as map_pages
from app.maps import routes as map_routes
from app.middleware import Edge
from app.observability import Metrics
from app.roads import routes as road_routes
from app.settings import Settings
from app.storage.resources import Resources
from app.trips import pages as trip_pages
from app.trips import routes as trip_routes
from app.uploads import pages as upload_pages
from app.uploads import routes as upload_routes
from app.webhooks import routes as webhook_routes

STREAMED = re.compile(f"{API}/(trips|uploads(/[^/]*)?|batteries/[^/]*/(data|curve))")
"""Where files come in, of any length."""


def create_app(settings: Settings | None = None) -> FastAPI:
    """Build the web application; its database must have been migrated (see `app.storage.migrate`)."""
    settings = settings or Settings()
    resources = Resources.open(settings)

    @asynccontextmanager
    async def lifespan(_app: FastAPI) -> AsyncIterator[None]:
        yield
        resources.close()

    app = FastAPI(
        title="Ponthy",
        version=__version__,
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
        responses=problems.PROBLEM_RESPONSES,
    )
    app.state.resources = resources
    app.state.authenticate = accounts.authenticate
    app.state.metrics = Metrics()
    app.state.tables = tables.METADATA
    problems.install(app)
    app.add_middleware(Edge, settings=settings, metrics=app.state.metrics, streamed=STREAMED)
    of_cars = (car_routes, car_calibration_routes, health_routes)
    of_driving = (drive_routes, battery_routes, eco_routes)  # a score's figures are asked for before others of a trip
    of_work = (upload_routes, trip_routes, job_routes, road_routes, webhook_routes)
    for slice_routes in (account_routes, *of_cars, *of_driving, map_routes, map_fit_routes, *of_work):
        app.include_router(slice_routes.router, prefix=API)
    of_views = (car_pages, trip_pages, eco_pages, map_pages, drive_pages, battery_pages, upload_pages, job_pages)
    for slice_pages in (pages, account_pages, *of_views, probes):
        app.include_router(slice_pages.router)
    return app
