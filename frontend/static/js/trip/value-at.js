/** Reading a drawn curve. */

/**
 * Value of a curve at a time, between its two neighbours (a stepped one keeps the earlier's); null outside, and next to a gap.
 * @param {{t: number[], value: (number|null)[], stepped?: boolean} | undefined} curve
 * @param {number} time
 */
export function valueAt(curve, time) {
  const { t, value } = curve ?? {};
  if (!t?.length || time < t[0] || time > t[t.length - 1]) return null;
  let [low, high] = [0, t.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  if (curve.stepped) return value[time === t[high] ? high : low];
  if (value[low] === null || value[high] === null) return null;
  const share = t[high] === t[low] ? 0 : (time - t[low]) / (t[high] - t[low]);
  return value[low] + share * (value[high] - value[low]);
}
