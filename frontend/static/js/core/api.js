/** Talking to `/api/v1`: JSON in and out, every failure a {@link Problem}. */

export const API = "/api/v1";

/** What went wrong, as problem+json tells it: `title`, `detail`, and where (`line`, `element`, `offset`, `row`, `field`). */
export class Problem extends Error {
  constructor(body, status) {
    super(body.detail || body.title || "Something went wrong.");
    Object.assign(this, body);
    this.status = status;
    this.title = body.title || "That did not work";
    this.detail = body.detail || "";
  }
}

/** Read a refused answer, whatever its form. */
export async function problemOf(response) {
  const text = await response.text();
  try {
    const body = JSON.parse(text);
    if (body && typeof body === "object") return new Problem(body, response.status);
  } catch {
    // Not JSON: a proxy's page, perhaps. The status still says something.
  }
  return new Problem({ title: `The server answered ${response.status}`, detail: text.slice(0, 200) }, response.status);
}

const early = new Map();

/** Ask now for what is going to be asked for: the next request for that address gets this answer. */
export function askAhead(url) {
  const answer = request(url);
  answer.catch(() => undefined); // told when it is asked for
  early.set(url, answer);
}

/** Send a request and return the answer, or throw a {@link Problem}. Signs in again when the session has ended. */
export async function request(path, options = {}) {
  const url = path.startsWith("/") ? path : `${API}/${path}`;
  const asked = options.method ? undefined : early.get(url);
  if (asked) {
    early.delete(url);
    return asked;
  }
  let response;
  try {
    response = await fetch(url, { credentials: "same-origin", ...options });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Problem({ title: "Ponthy does not answer", code: "offline",
      detail: "Is it still running, and is this computer connected? The page tries again when you do." }, 0);
  }
  if (response.ok) return response;
  if (response.status === 401 && location.pathname !== "/login") {
    location.assign(`/login?next=${encodeURIComponent(location.pathname + location.search)}`);
  }
  throw await problemOf(response);
}

async function json(response) {
  return response.status === 204 ? null : response.json();
}

const withBody = (method) => async (path, body, options = {}) =>
  json(await request(path, { method, headers: { "Content-Type": "application/json" }, body: JSON.stringify(body ?? {}), ...options }));

export const get = async (path, options) => json(await request(path, options));
export const post = withBody("POST");
export const put = withBody("PUT");
export const patch = withBody("PATCH");
export const remove = async (path) => json(await request(path, { method: "DELETE" }));

/** Send an XML document. */
export async function sendXml(method, path, xml) {
  return json(await request(path, { method, headers: { "Content-Type": "application/xml" }, body: xml }));
}

/** Build a query string; empty values are left out, arrays are joined by commas. */
export function query(values) {
  const pairs = Object.entries(values).filter(([, v]) => v !== null && v !== undefined && v !== "");
  const text = new URLSearchParams(pairs.map(([k, v]) => [k, Array.isArray(v) ? v.join(",") : String(v)])).toString();
  return text ? `?${text}` : "";
}

/** Address of something of that id. */
export const at = (kind, id, rest = "") => `${kind}/${encodeURIComponent(id)}${rest}`;
