"""An efficiency map as a picture for reports."""

from __future__ import annotations

from io import BytesIO
from math import pi
from threading import Lock
from typing import Any, Literal

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.operating_line import optimal_operating_line
from app.science.engine.raster import MapRaster, confidence, raster, smoothed
from app.science.engine.reading import Peak, peak
from app.science.errors import TooLittleData

Form = Literal["png", "svg"]
SIZE_IN = (8.0, 5.2)
DPI = 150
INK, QUIET, HIGHLIGHT = "#1b1f24", "#5c6670", "#d6336c"
POWERS_KW = (2, 5, 10, 15, 20, 30, 40, 50, 60, 80, 100, 150, 200, 300)

_DRAWING = Lock()  # Matplotlib's font cache is not safe to use from several threads


def map_image(efficiency_map: EfficiencyMap, *, title: str, form: Form = "png") -> bytes:
    """Draw the map on white: cells fainter where less is known, isolines, full load, power, the most efficient line.

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    title : str
    form : {"png", "svg"}

    Raises
    ------
    TooLittleData
        When no cell is trusted.
    """
    best = peak(efficiency_map)
    if best is None:
        raise TooLittleData("No cell of this map has enough points that agree, so there is nothing to draw yet.")
    with _DRAWING:
        return _drawn(efficiency_map, best, title, form)


def _drawn(efficiency_map: EfficiencyMap, best: Peak, title: str, form: Form) -> bytes:
    import matplotlib as mpl  # slow to load, and seldom needed by a server
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    mpl.rcParams["svg.hashsalt"] = "ponthy"  # the same map gives the same bytes; there is no other place to say so
    cells = raster(efficiency_map)
    figure = Figure(figsize=SIZE_IN, dpi=DPI, layout="constrained")
    axes: Any = figure.add_subplot()
    percent = 100.0 * cells.efficiency
    low, high = np.nanpercentile(percent, [1.0, 99.0])
    mesh = axes.pcolormesh(
        _edges(cells.rpm, cells.grid.rpm),
        _edges(cells.nm, cells.grid.nm),
        np.ma.masked_invalid(percent),
        alpha=0.25 + 0.75 * confidence(cells),
        vmin=np.floor(low),
        vmax=np.ceil(high),
        rasterized=True,
    )
    scale = figure.colorbar(mpl.cm.ScalarMappable(mesh.norm, mesh.cmap), ax=axes, pad=0.09)
    scale.set_label("Efficiency, %")
    _isolines(axes, cells)
    top = 1.08 * float(efficiency_map.full_load_nm.max())
    _power_lines(axes, cells, top)
    line = optimal_operating_line(efficiency_map)
    axes.plot(line.rpm, line.nm, color="white", linewidth=3.5)
    axes.plot(line.rpm, line.nm, color=HIGHLIGHT, linewidth=1.8, label="most efficient per power")
    _full_load(axes, efficiency_map)
    label = (
        f"best: {100.0 * best.efficiency:.1f} % ({best.bsfc_gpkwh:.0f} g/kWh) at {best.rpm:.0f} rpm, {best.nm:.0f} Nm"
    )
    axes.plot(
        best.rpm, best.nm, "*", color=HIGHLIGHT, markeredgecolor="white", markersize=15, linestyle="none", label=label
    )
    axes.set(xlabel="Engine speed, rpm", ylabel="Torque, Nm", ylim=(0.0, top))
    axes.set_title(title, loc="left", fontsize=11, parse_math=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside lower left", ncols=3, frameon=False, fontsize=8)
    sink = BytesIO()
    canvas: Any = (FigureCanvasSVG if form == "svg" else FigureCanvasAgg)(figure)
    if form == "svg":
        canvas.print_svg(sink, metadata={"Date": None})
    else:
        canvas.print_png(sink, metadata={"Software": None})
    return sink.getvalue()


def _full_load(axes: Any, m: EfficiencyMap) -> None:
    """Draw the full load solid where it was reached, and dotted where it is a lower bound."""
    axes.plot(m.full_load_rpm, m.full_load_nm, ":", color=INK, linewidth=1.4, label="highest torque seen")
    if m.full_load_reached is not None and m.full_load_reached.any():
        reached = np.ma.masked_where(~m.full_load_reached, m.full_load_nm)
        axes.plot(m.full_load_rpm, reached, color=INK, linewidth=1.4, label="full load")


def _isolines(axes: Any, cells: MapRaster) -> None:
    smooth = np.ma.masked_invalid(100.0 * smoothed(cells).filled)
    if min(smooth.shape) < 2:
        return
    lines = axes.contour(cells.rpm, cells.nm, smooth, levels=np.arange(0.0, 60.0, 2.0), colors=INK, linewidths=0.6)
    axes.clabel(lines, fontsize=7, fmt="%g")


def _power_lines(axes: Any, cells: MapRaster, top: float) -> None:
    rpm = np.linspace(cells.rpm[0] - cells.grid.rpm, cells.rpm[-1] + cells.grid.rpm, 60)
    axes.set_xlim(rpm[0], rpm[-1])
    for power in POWERS_KW:
        torque = 1000.0 * power / (rpm * pi / 30.0)
        if torque[-1] < 0.95 * top:
            axes.plot(rpm, torque, ":", color=QUIET, linewidth=0.7)
            axes.annotate(
                f"{power} kW", (rpm[-1], torque[-1]), (3, 0), textcoords="offset points", va="center", fontsize=7
            )


def _edges(centres: FloatArray, width: float) -> FloatArray:
    return np.append(centres - 0.5 * width, centres[-1] + 0.5 * width)
