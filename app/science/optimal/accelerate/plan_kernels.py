"""Gears over speed: where two cost the same, integrals between such places, and the cheapest sequence."""

from __future__ import annotations

import math

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.jit import kernel
from app.science.optimal.accelerate.integral_kernels import INSET, SHARP, Pricing, integrate
from app.science.optimal.accelerate.kernels import GEARS, NEUTRAL, WILLANS, DriveNumbers, cheapest_in

CELLS = 36
HOPELESS = 4.0


@kernel
def knots(slow: float, fast: float, pin: float, drive: DriveNumbers) -> FloatArray:
    """Return the speeds between two at which a limit of some gear has an end or a corner, ends included, in order."""
    found = [slow, fast]
    if slow < pin < fast:
        found.append(pin)
    if drive.kind == GEARS:
        for gear in range(len(drive.spd_1pm)):
            n = drive.spd_1pm[gear]
            found.append(drive.engine.lowest_radps / n)
            found.append(drive.engine.highest_radps / n)
            found.extend([omega / n for omega in drive.engine.full_load_radps])
    elif drive.kind == WILLANS:
        found.extend([drive.power_w[k] / drive.force_n[k] for k in range(2) if drive.force_n[k] != 0.0])
    found.sort()
    kept = [slow]
    for v in found:
        if kept[-1] + INSET * fast < v < fast - INSET * fast:
            kept.append(v)
    kept.append(fast)
    return np.array(kept)


@kernel
def crossing(i: int, j: int, a: float, b: float, price: Pricing, drive: DriveNumbers) -> float:
    """Return the speed between a and b at which two gears cost the same; their order must differ at a and b."""
    off_a = difference(i, j, a, price, drive)
    off_b = difference(i, j, b, price, drive)
    first, last = off_a < 0.0, math.nan
    for _ in range(80):
        middle = 0.5 * (a + b)
        if abs(off_a) < math.inf and abs(off_b) < math.inf:
            middle = (a * off_b - b * off_a) / (off_b - off_a)
        if not a < middle < b or abs(middle - last) < SHARP * b:
            break
        last = middle
        off = difference(i, j, middle, price, drive)
        if off == 0.0:
            return middle
        if (off < 0.0) == first:
            a, off_a = middle, off
            off_b *= 0.5
        else:
            b, off_b = middle, off
            off_a *= 0.5
    return last if last == last else 0.5 * (a + b)


@kernel
def difference(i: int, j: int, v: float, price: Pricing, drive: DriveNumbers) -> float:
    """Return by how much gear i costs more than gear j at a speed; 0 where neither can be used."""
    one = cheapest_in(i, v, price.mu_w, price.weight, price.sign, drive).cost
    two = cheapest_in(j, v, price.mu_w, price.weight, price.sign, drive).cost
    return one - two if one != two else 0.0


@kernel
def costs_at(v: float, price: Pricing, drive: DriveNumbers) -> FloatArray:
    """Return the cheapest cost at a speed in each gear; the last one is neutral."""
    gears = len(drive.spd_1pm)
    costs = np.empty(gears + 1)
    for gear in range(gears):
        costs[gear] = cheapest_in(gear, v, price.mu_w, price.weight, price.sign, drive).cost
    costs[gears] = cheapest_in(NEUTRAL, v, price.mu_w, price.weight, price.sign, drive).cost
    return costs


@kernel
def gear_of(column: int, drive: DriveNumbers) -> int:
    """Return the gear that a column of costs stands for."""
    return column if column < len(drive.spd_1pm) else NEUTRAL


@kernel
def meetings(speeds: FloatArray, every: bool, price: Pricing, drive: DriveNumbers) -> FloatArray:
    """Return knots and the places between them where gears cost the same: any two, or only the cheapest two."""
    places = [speeds[0]]
    gears = len(drive.spd_1pm) + 1
    for k in range(len(speeds) - 1):
        a, b = speeds[k], speeds[k + 1]
        inset = INSET * (b - a)
        cells = max(2, math.ceil(CELLS * (b - a) / (speeds[-1] - speeds[0])))
        step = (b - a - 2.0 * inset) / cells
        before = costs_at(a + inset, price, drive)
        for cell in range(cells):
            low, high = a + inset + cell * step, a + inset + (cell + 1) * step
            after = costs_at(high, price, drive)
            if every:
                for i in range(gears):
                    for j in range(i):
                        usable = before[i] + before[j] + after[i] + after[j]
                        if abs(usable) < math.inf and (before[i] < before[j]) != (after[i] < after[j]):
                            places.append(crossing(gear_of(i, drive), gear_of(j, drive), low, high, price, drive))
            else:
                lowest_meetings(places, low, high, int(before.argmin()), int(after.argmin()), price, drive)
            before = after
        places.append(b)
    found = np.array(places)
    found.sort()
    kept = [found[0]]
    for v in found[1:]:
        if v - kept[-1] > INSET * (speeds[-1] - speeds[0]):
            kept.append(v)
    kept[-1] = speeds[-1]
    return np.array(kept)


@kernel
def lowest_meetings(
    places: list[float], low: float, high: float, at_low: int, at_high: int, price: Pricing, drive: DriveNumbers
) -> None:
    """Add the places between two speeds where the cheapest gear changes; a third one between two is found, too."""
    stack = [(low, high, at_low, at_high)]
    while len(stack) > 0:
        a, b, i, j = stack.pop()
        if i == j or b - a < INSET * high:
            continue
        v = crossing(gear_of(i, drive), gear_of(j, drive), a, b, price, drive)
        costs = costs_at(v, price, drive)
        k = int(costs.argmin())
        if costs[k] < min(costs[i], costs[j]) * (1.0 - 1e-12) and k != i and k != j:
            stack.append((a, v, i, k))
            stack.append((v, b, k, j))
        else:
            places.append(v)


@kernel
def cheapest_columns(places: FloatArray, price: Pricing, drive: DriveNumbers) -> IntArray:
    """Return the cheapest gear of each section, by its middle; −1 where there is none."""
    found = np.empty(len(places) - 1, np.int64)
    for k in range(len(found)):
        costs = costs_at(0.5 * (places[k] + places[k + 1]), price, drive)
        at = int(costs.argmin())
        found[k] = at if costs[at] < math.inf else -1
    return found


@kernel
def section_sums(places: FloatArray, columns: IntArray, price: Pricing, drive: DriveNumbers) -> FloatArray:
    """Return the integrals of each section in one gear, shape (sections, 4)."""
    sums = np.empty((len(columns), 4))
    for k in range(len(columns)):
        found = integrate(gear_of(columns[k], drive), places[k], places[k + 1], price, drive)
        sums[k, 0], sums[k, 1], sums[k, 2], sums[k, 3] = found.cost, found.fuel_j, found.time_s, found.distance_m
    return sums


@kernel
def all_sums(places: FloatArray, charge: float, price: Pricing, drive: DriveNumbers) -> FloatArray:
    """Return the integrals of each section in each gear, shape (sections, gears + 1, 4).

    A gear that costs more in a section than leaving it twice is passed over: its costs stay infinite.
    """
    sections, gears = len(places) - 1, len(drive.spd_1pm) + 1
    sums = np.full((sections, gears, 4), math.inf)
    for k in range(sections):
        costs = costs_at(0.5 * (places[k] + places[k + 1]), price, drive)
        for column in range(gears):
            dearer = (costs[column] - costs.min()) * (places[k + 1] - places[k])
            if abs(costs[column]) < math.inf and dearer <= HOPELESS * charge:
                found = integrate(gear_of(column, drive), places[k], places[k + 1], price, drive)
                sums[k, column, 0], sums[k, column, 1] = found.cost, found.fuel_j
                sums[k, column, 2], sums[k, column, 3] = found.time_s, found.distance_m
    return sums


@kernel
def cheapest_sequence(costs: FloatArray, charge: float) -> IntArray:
    """Return the gear of each section for which cost and charges for changes are least, sections in driving order."""
    sections, gears = costs.shape
    total = costs[0].copy()
    came_from = np.zeros((sections, gears), np.int64)
    for k in range(1, sections):
        least = int(total.argmin())
        changed = total[least] + charge
        for j in range(gears):
            stays = total[j] <= changed
            came_from[k, j] = j if stays else least
            total[j] = costs[k, j] + (total[j] if stays else changed)
    path = np.empty(sections, np.int64)
    path[sections - 1] = int(total.argmin())
    for k in range(sections - 1, 0, -1):
        path[k - 1] = came_from[k, path[k]]
    return path


@kernel
def cheapest_along(costs: FloatArray, sequence: IntArray) -> IntArray:
    """Return the gear of each section for the least cost when gears may follow each other in one order only.

    Every gear of the sequence is used; −1 in the first place where that can't be.
    """
    sections, steps = costs.shape[0], len(sequence)
    total = np.full(steps, math.inf)
    total[0] = costs[0, sequence[0]]
    stays = np.zeros((sections, steps), np.bool_)
    for k in range(1, sections):
        for j in range(steps - 1, -1, -1):
            before = total[j - 1] if j > 0 else math.inf
            stays[k, j] = total[j] <= before
            total[j] = min(total[j], before) + costs[k, sequence[j]]
    path = np.full(sections, -1, np.int64)
    if not total[steps - 1] < math.inf:
        return path
    j = steps - 1
    for k in range(sections - 1, -1, -1):
        path[k] = sequence[j]
        if k > 0 and not stays[k, j]:
            j -= 1
    return path


@kernel
def planned(
    slow: float, fast: float, charge: float, price: Pricing, drive: DriveNumbers
) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return sections over speed, the gear of each, and its integrals; the first gear is −1 where there is no way.

    Sections are in the order of rising speed, shape (sections + 1,), (sections,) and (sections, 4).
    """
    speeds = knots(slow, fast, price.pin_mps, drive)
    if drive.kind != GEARS and (price.sign > 0.0 or not drive.neutral):
        only = np.zeros(len(speeds) - 1, np.int64)
        return speeds, only, section_sums(speeds, only, price, drive)
    if charge == 0.0:
        places = meetings(speeds, False, price, drive)
        columns = cheapest_columns(places, price, drive)
        if columns.min() < 0:
            columns[0] = -1
            return places, columns, np.empty((0, 4))
        return places, columns, section_sums(places, columns, price, drive)
    places = meetings(speeds, True, price, drive)
    sums = all_sums(places, charge, price, drive)
    path = cheapest_sequence(in_order(sums[:, :, 0], price), charge)
    if price.sign < 0.0:
        path = path[::-1].copy()
    sums = chosen(sums, path)
    if not sums[:, 0].sum() < math.inf:
        path[0] = -1
    return places, path, sums


@kernel
def everything(slow: float, fast: float, price: Pricing, drive: DriveNumbers) -> tuple[FloatArray, FloatArray]:
    """Return all places at which a change of gears can be best, and the integrals between them in every gear."""
    places = meetings(knots(slow, fast, price.pin_mps, drive), True, price, drive)
    return places, all_sums(places, math.inf, price, drive)


@kernel
def in_order(rows: FloatArray, price: Pricing) -> FloatArray:
    """Return rows of sections in driving order: slowing down, the fastest comes first."""
    return rows.copy() if price.sign > 0.0 else rows[::-1].copy()


@kernel
def chosen(sums: FloatArray, path: IntArray) -> FloatArray:
    """Return the integrals of each section in its gear, shape (sections, 4)."""
    found = np.empty((len(path), 4))
    for k in range(len(path)):
        found[k] = sums[k, path[k]]
    return found
