"""Panels above each other with one time axis."""

from __future__ import annotations

from dataclasses import dataclass

from app.figures.theme import Json, Theme

BELOW_PX = 44


@dataclass(frozen=True, slots=True)
class Panels:
    """Heights in pixels; row 0 is the uppermost panel. A gap holds the heading of the panel below it."""

    rows: int
    panel_px: int
    gap_px: int

    @property
    def height(self) -> int:
        """Height of the whole figure with the time axis below."""
        return self.rows * (self.panel_px + self.gap_px) + BELOW_PX

    def domain(self, row: int) -> list[float]:
        """Return the part of the plot's height that a row takes."""
        whole = self.rows * (self.panel_px + self.gap_px) - self.gap_px
        top = 1.0 - row * (self.panel_px + self.gap_px) / whole
        return [round(max(top - self.panel_px / whole, 0.0), 4), round(top, 4)]

    def y(self, row: int) -> str:
        """Return the name by which traces call the row's axis; ``yaxis`` plus its number is its entry."""
        return f"y{row + 1}" if row else "y"

    def time_axis(self) -> Json:
        """Return what places the time axis under the lowest panel."""
        return {"anchor": self.y(self.rows - 1), "domain": [0, 1]}

    def heading(self, row: int, label: str, unit: str, theme: Theme) -> Json:
        """Return a panel's name above its top left corner, where a phone has room for it."""
        return {
            "text": f'{label} <span style="color:{theme.quiet}">{unit}</span>' if unit else label,
            "xref": "paper",
            "yref": f"{self.y(row)} domain",
            "x": 0,
            "y": 1,
            "xanchor": "left",
            "yanchor": "bottom",
            "showarrow": False,
            "font": {"size": 12, "color": theme.ink},
        }

    def axis_entry(self, row: int) -> str:
        """Return the row's key in the layout."""
        return f"yaxis{self.y(row)[1:]}"
