/** What this browser remembers of unfinished uploads, so that the same file goes on where it stopped. */

const KEY = "ponthy-uploads";
const KEEP_MS = 14 * 24 * 3600 * 1000;

function read() {
  try {
    const entries = JSON.parse(localStorage.getItem(KEY) ?? "{}");
    return Object.fromEntries(Object.entries(entries).filter(([, entry]) => Date.now() - entry.at < KEEP_MS));
  } catch {
    return {};
  }
}

function write(entries) {
  try {
    localStorage.setItem(KEY, JSON.stringify(entries));
  } catch {
    // Storage is full or blocked: the upload works all the same, it only can't be resumed after a reload.
  }
}

/** What tells a file apart without reading it. */
const keyOf = (file, carId) => [file.name, file.size, file.lastModified, carId ?? ""].join("|");

/** Remember where a file is being sent. */
export function remember(file, metadata, url) {
  write({ ...read(), [keyOf(file, metadata.car_id)]: { url, name: file.name, size: file.size, modified: file.lastModified, metadata, at: Date.now() } });
}

/** Forget an upload that is finished or given up. */
export function forget(url) {
  write(Object.fromEntries(Object.entries(read()).filter(([, entry]) => entry.url !== url)));
}

/** All unfinished uploads, oldest first. */
export function unfinished() {
  return Object.values(read()).sort((a, b) => a.at - b.at);
}

/** The unfinished upload of this very file, if there is one. */
export function entryOf(file) {
  return unfinished().find((entry) => entry.name === file.name && entry.size === file.size && entry.modified === file.lastModified) ?? null;
}
