/** Appearance, session, access tokens, webhooks, elevation tables and the map's tiles. */

import { at, get, post, remove } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { number, when } from "../core/format.js";
import { busy, guarded } from "../core/notify.js";
import { countJobs, session } from "../core/shell.js";
import { chooseTheme, chosenTheme } from "../core/theme.js";
import { askName, confirmed, table } from "../core/ui.js";
import { showWebhooks } from "../settings/webhooks.js";

const th = (text, kind) => h("th", { scope: "col", class: kind }, text);

function appearance() {
  const switcher = byId("theme-switch");
  switcher.querySelector(`input[value="${chosenTheme()}"]`).checked = true;
  switcher.addEventListener("change", (event) => chooseTheme(event.target.value));
}

async function showSession() {
  const me = await session();
  const rows = [
    ["Fleet", me.fleet.name],
    ["You", me.user ? [...new Set([me.user.name, me.user.email])].filter(Boolean).join(", ") : "The one person at this computer; no login on loopback"],
    ["Version", me.version], ["Code", h("code", {}, me.code_version.slice(0, 12))],
  ];
  show(byId("session"), rows.map(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
  show(byId("session-action"), me.user && h("button", { class: "btn small", on: { click: (event) => busy(event.currentTarget, async () => {
    await remove("session");
    location.assign("/login");
  }) } }, "Sign out"));
  show(byId("tiles"), me.tiles
    ? h("p", {}, "The map draws tiles from ", h("code", {}, me.tiles.url), me.tiles.attribution && ` (${me.tiles.attribution})`, ".")
    : h("p", { class: "quiet" }, "None: the map is drawn on a plain ground and asks no other host for anything. Set ", h("code", {}, "PONTHY_TILES_URL"), " to use a tile source."));
}

/** A row's button that takes something away after asking. */
function remover(word, title, text, path, after) {
  return h("button", { class: "btn bare small", on: { click: (event) => busy(event.currentTarget, async () => {
    if (!(await confirmed(title, text, word))) return;
    await remove(path);
    await after();
  }) } }, word);
}

async function showTokens() {
  const { items } = await get("tokens");
  show(byId("tokens"), items.length === 0 ? h("p", { class: "quiet" }, "No tokens.") : table("Access tokens",
    h("tr", {}, th("Name"), th("Made"), th("Last used"), h("td", {})),
    items.map((token) => h("tr", {}, h("th", { scope: "row" }, token.name), h("td", {}, when(token.created_at)), h("td", {}, when(token.last_used_at)),
      h("td", { class: "row-actions" }, remover("Revoke", `Revoke “${token.name}”?`, "Whatever uses it is refused from now on.", at("tokens", token.id), showTokens))))));
}

async function newToken() {
  const name = await askName("New token", "What will use it?", "", "Make token");
  if (!name) return;
  const made = await post("tokens", { name });
  await showTokens();
  byId("tokens").prepend(h("div", { class: "note", role: "status" }, h("p", {}, "Copy it now; it is not shown again."), h("p", { class: "token" }, h("code", {}, made.token))));
}

async function showRoads() {
  const { items } = await get("roads");
  const degrees = ([south, west, north, east]) => `${number(south, 2)}…${number(north, 2)}° N, ${number(west, 2)}…${number(east, 2)}° E`;
  show(byId("roads"), items.length === 0 ? h("p", { class: "quiet" }, "None yet.") : table("Elevation tables",
    h("tr", {}, th("Name"), th("Points", "n"), th("Covers"), th("Added"), h("td", {})),
    items.map((road) => h("tr", {}, h("th", { scope: "row" }, road.name), h("td", { class: "n" }, number(road.nodes)), h("td", { class: "nowrap" }, degrees(road.bounds)), h("td", {}, when(road.created_at)),
      h("td", { class: "row-actions" }, remover("Remove", `Remove “${road.name}”?`, "Trips keep what was computed with it until they run again.", at("roads", road.id), showRoads))))));
}

appearance();
byId("new-token").addEventListener("click", (event) => busy(event.currentTarget, newToken));
await guarded(() => Promise.all([showSession(), showTokens(), showWebhooks(), showRoads(), countJobs()]));
