"""``./ponthy road``: a track, a table or a driving cycle as the road of a drive problem."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import AsJson
from app.cli.output import note, say, table, write_json

if TYPE_CHECKING:
    from collections.abc import Mapping

    from app.science.optimal.posing.heights import Heights

KMH = 3.6
TILES = (".hgt", ".zip")
Input = Annotated[Path, typer.Argument(metavar="FILE", exists=True, dir_okay=False, readable=True)]
Kmh = Annotated[float | None, typer.Option(min=0.1, max=500.0, help="Speed limit where the file says none, km/h.")]
Output = Annotated[Path | None, typer.Option("--out", dir_okay=False, help="Where to write it.")]


def road(
    file: Input,
    elevation: Annotated[
        list[Path] | None,
        typer.Option(exists=True, dir_okay=False, help="Tiles such as N42E001.hgt, or a table of roads."),
    ] = None,
    osm: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Map .osm.pbf whose limits hold on a track.")
    ] = None,
    way: Annotated[str | None, typer.Option(help="Of a map as FILE: the road, by number or name.")] = None,
    backwards: Annotated[bool, typer.Option("--backwards", help="Of a map: drive that road the other way.")] = False,
    limit: Kmh = None,
    level: Annotated[bool, typer.Option("--level", help="Leave heights out.")] = False,
    smooth: Annotated[
        float | None, typer.Option(min=0.0, max=5000.0, help="Smoothing of heights, m; 30 for a track, 100 with tiles.")
    ] = None,
    tolerance: Annotated[float, typer.Option(min=0.0, max=50.0, help="Heights may be off by that much, m.")] = 0.25,
    gap: Annotated[float, typer.Option(min=1.0, help="Longest way without a point, m.")] = 2000.0,
    part: Annotated[int | None, typer.Option(min=1, help="Of a cycle with stops; else the longest.")] = None,
    out: Output = None,
    as_json: AsJson = False,
) -> None:
    """Make the road of a drive problem from a GPX track, a map, a table or a driving cycle.

    A table has distance_m, elevation_m and speed_limit_kmh (or _mps), or lat_deg and lon_deg. A cycle has time_s and
    speed_mps; its speed becomes the limit, and stops divide it.
    """
    from app.imports.osm import read_osm
    from app.imports.road import RoadWishes, longest, read_roads, told
    from app.science.optimal.posing.cleaning import Cleaning

    heights = model(elevation) if elevation else None
    cleaning = Cleaning(tolerance_m=tolerance, longest_gap_m=gap)
    roads_known = read_osm(osm.read_bytes()) if osm else None
    wishes = RoadWishes(
        None if limit is None else limit / KMH, heights, level, smooth, cleaning, roads_known, way, backwards
    )
    roads = read_roads(file.read_bytes(), wishes)
    if part is not None and part > len(roads):
        raise typer.BadParameter(f"--part {part}: the cycle has {len(roads)} parts between its stops")
    chosen = longest(roads) if part is None else part - 1
    found = told(roads, chosen)
    if out is not None:
        write_json(out, roads[chosen].road_document())
        note(f"{out}: {found['points']} points, {found['length_m'] / 1000.0:.2f} km")
    say(found, as_json, words(found))


def model(paths: list[Path]) -> Heights:
    """Return an elevation model: a table of roads as ``./ponthy simulate`` writes one, or tiles."""
    from app.imports.elevation import read_elevation
    from app.imports.hgt import read_hgt
    from app.science.optimal.posing.heights import RoadHeights
    from app.science.roads.elevation import join_tables

    files = [(path.name, path.read_bytes()) for path in paths]
    if all(path.suffix.lower() in TILES for path in paths):
        return read_hgt(files)
    return RoadHeights(", ".join(name for name, _ in files), join_tables(read_elevation(data) for _, data in files))


def words(found: Mapping[str, Any]) -> str:
    """Return a road in words."""
    limits = [KMH * limit for limit in found["road"]["speed_limit_mps"]]
    rows = [
        ["length", f"{found['length_m'] / 1000.0:.3f}", "km"],
        ["points", str(found["points"]), ""],
        ["climbs", f"{found['climb_m']:.1f}", "m"],
        ["limits", f"{min(limits):.0f} to {max(limits):.0f}", "km/h"],
    ]
    if found["time_s"] is not None:
        rows.append(["driven in", f"{found['time_s']:.1f}", "s"])
        ends = f"{KMH * found['from_speed_mps']:.1f} to {KMH * found['to_speed_mps']:.1f}"
        rows.append(["from and to", ends, "km/h"])
    if len(found["parts"]) > 1:
        rows.append(["part", f"{found['part']} of {len(found['parts'])}", ""])
    return "\n".join([table(rows), *found["notes"]])
