/** Reading and writing fields of a problem by their paths, such as `vehicle.mass_kg`. */

/** The value at a path; undefined where there is none. */
export const valueOf = (problem, path) => path.split(".").reduce((inside, key) => inside?.[key], problem);

/** Put a value at a path; undefined takes the field away, and what is empty without it. Objects on the way are made. */
export function put(problem, path, value) {
  const keys = path.split(".");
  const last = keys.pop();
  let inside = problem;
  for (const key of keys) inside = inside[key] ??= {};
  if (value !== undefined) {
    inside[last] = value;
    return;
  }
  delete inside[last];
  if (keys.length > 0 && Object.keys(inside).length === 0) put(problem, keys.join("."), undefined);
}

/** The path of the field that a problem's path speaks of: `transmission.ratios[2]` is in `transmission.ratios`. */
export const fieldOf = (path) => String(path ?? "").replace(/^body\.(problem\.)?/, "").replace(/\[\d+\].*$/, "");

/** A number as the reader typed it: thin spaces, a comma, a true minus; the text itself where it is none. */
export function typedNumber(text) {
  const plain = text.trim().replace(/[\s\u202f]/g, "").replace(/^([-−]?\d+),(\d+)$/, "$1.$2").replace("−", "-");
  const value = Number(plain);
  return plain === "" || Number.isNaN(value) ? text : value;
}

/** A number to be edited, rounded for the eye: the document keeps what it has until somebody types. */
export const editable = (value) => (typeof value === "number" ? String(Number(value.toPrecision(7))) : String(value ?? ""));

/** A refusal without the path it begins with, for where the field itself is shown. */
export function plainly(detail, path) {
  const text = path && detail.startsWith(`${path}: `) ? detail.slice(path.length + 2) : detail;
  return text.charAt(0).toUpperCase() + text.slice(1);
}
