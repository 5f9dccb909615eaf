/** What a dropped file is, by its name and its first bytes. */

const HEAD = 4096;
const ELEVATION = /^\uFEFF?\s*lat_deg\s*,\s*lon_deg\s*,\s*alt_m\s*(,\s*way\s*)?$/i;

/** "car", "elevation", "mapping" or "trip". */
export async function kindOf(file) {
  const head = await file.slice(0, HEAD).text();
  if (/\.xml$/i.test(file.name) || /^\uFEFF?\s*<(\?xml|ponthy_config)/i.test(head)) return "car";
  if (/\.json$/i.test(file.name)) return "mapping";
  if (/\.csv$/i.test(file.name) && ELEVATION.test(head.split(/\r?\n/, 1)[0])) return "elevation";
  return "trip";
}

/** How the kinds are called on the page. */
export const KIND_NAMES = { car: "Car file", elevation: "Elevation table", mapping: "Mapping", trip: "Trip" };

/** Whether a mapping of column names can concern a file: tables, alone or in an archive. */
export const isTable = (file) => /\.(csv|tsv|txt|parquet|zip)(\.gz)?$/i.test(file.name);
