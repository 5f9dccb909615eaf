/** What an efficiency map says in a few numbers. Pure functions of `map.json`. */

/** Middle of a list of numbers, or null. */
function median(values) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  if (sorted.length === 0) return null;
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/** Cells with enough agreeing points to have an efficiency. */
export const trusted = (map) => map.cells.filter((cell) => Number.isFinite(cell.efficiency));

/**
 * Share of the area below the full-load line that has trusted cells, 0 to 1; null without a line.
 *
 * The line ends where the car has not been seen at full load, so this speaks of the part of the engine's range that
 * was driven, as the figure shows it.
 */
export function coverage(map) {
  const line = [...(map.full_load ?? [])].sort((a, b) => a[0] - b[0]);
  if (line.length < 2) return null;
  let possible = 0;
  for (let i = 1; i < line.length; i += 1) {
    const [[rpm0, nm0], [rpm1, nm1]] = [line[i - 1], line[i]];
    possible += ((rpm1 - rpm0) / map.cell.rpm) * ((nm0 + nm1) / 2 / map.cell.nm);
  }
  return possible > 0 ? Math.min(1, trusted(map).length / possible) : null;
}

/** Two standard deviations of the points within a typical trusted cell, as a fraction of 1. */
export function spread(map) {
  const sd = median(trusted(map).map((cell) => cell.sd));
  return sd === null ? null : 2 * sd;
}
