/** Webhooks: whom to tell of what, what each was told, a test, and once more. */

import { at, get, patch, post, remove } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { number, when } from "../core/format.js";
import { announce, busy, complain, toast } from "../core/notify.js";
import { agreed, confirmed, paged, table } from "../core/ui.js";
import { deliveryMark, webhookMark } from "../core/verdict.js";

const EVENTS = [
  ["trip.ready", "a trip is ready"], ["trip.failed", "a trip failed"], ["map.updated", "a car’s map has a new version"],
  ["health.alert", "a car’s health changed"], ["health.cleared", "that is over"],
  ["battery.ready", "a trip or file told of a battery"],
];
const TRIES = 60;
const TRY_EVERY_MS = 1000;

/** The webhook whose deliveries are shown. */
let looked = null;

const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
const button = (word, act) => h("button", { class: "btn bare small", on: { click: (event) => busy(event.currentTarget, act) } }, word);

function form(webhook) {
  const url = h("input", { id: "webhook-url", type: "url", value: webhook?.url ?? "", maxLength: 2000, required: true, autocomplete: "off" });
  const words = h("input", { id: "webhook-words", value: webhook?.description ?? "", maxLength: 200, autocomplete: "off" });
  const boxes = EVENTS.map(([name, told]) => [name, told, h("input", { type: "checkbox", id: `webhook-${name}`, checked: webhook ? webhook.events.includes(name) : name.startsWith("health") })]);
  const body = h("div", {},
    h("div", { class: "field" }, h("label", { htmlFor: "webhook-url" }, "Address (https)"), url),
    h("div", { class: "field" }, h("label", { htmlFor: "webhook-words" }, "What it is for"), words),
    h("fieldset", {}, h("legend", {}, "Tell it when"),
      boxes.map(([name, told, box]) => h("p", {}, box, " ", h("label", { htmlFor: box.id }, told, " ", h("code", {}, name))))));
  return { body, values: () => ({ url: url.value.trim(), description: words.value.trim(), events: boxes.filter(([, , box]) => box.checked).map(([name]) => name) }) };
}

function tellSecret(webhook) {
  show(byId("webhook-secret"), h("div", { class: "note section", role: "status" },
    h("p", {}, `The secret that signs what ${webhook.url} is told. Copy it now; it is not shown again.`),
    h("p", { class: "token" }, h("code", {}, webhook.secret))));
}

async function add() {
  const { body, values } = form();
  if (!(await agreed("New webhook", body, "Make webhook"))) return;
  const made = await post("webhooks", values());
  await showWebhooks();
  tellSecret(made);
}

async function edit(webhook) {
  const { body, values } = form(webhook);
  if (!(await agreed("Change webhook", body, "Save"))) return;
  await patch(at("webhooks", webhook.id), values());
  await showWebhooks();
}

async function renew(webhook) {
  if (!(await confirmed("Make a new secret?", "From now on nothing is signed with the old one; its receiver needs the new one at once.", "New secret"))) return;
  tellSecret(await post(at("webhooks", webhook.id, "/secret")));
}

async function drop(webhook) {
  if (!(await confirmed("Remove this webhook?", "It is told nothing more, and what it was told is forgotten.", "Remove"))) return;
  await remove(at("webhooks", webhook.id));
  await showWebhooks();
}

/** Follow a delivery until it has been tried, and show how that ended wherever its webhook is still looked at. */
async function follow(webhook, sent) {
  for (let tries = 0; tries < TRIES; tries += 1) {
    await new Promise((resolve) => setTimeout(resolve, TRY_EVERY_MS));
    const { items } = await get(at("webhooks", webhook.id, "/deliveries"));
    const ended = items.find((delivery) => delivery.id === sent.id);
    if (!ended) return;
    if (ended.state === "waiting" && !ended.error) continue;
    toast(ended.state === "delivered" ? `Delivered; the receiver answered ${ended.status}.` : `Not delivered: ${ended.error}.`);
    await showList();
    if (looked === webhook.id) await showDeliveries(webhook);
    return;
  }
}

async function deliver(webhook, path) {
  const sent = await post(path);
  await showDeliveries(webhook);
  follow(webhook, sent).catch(complain);
}

const told = (delivery) => [delivery.error, delivery.state === "waiting" && delivery.attempts > 0 && `again at ${when(delivery.next_try_at).textContent}`].filter(Boolean).join("; ");

function deliveryRow(webhook, delivery) {
  return h("tr", {}, h("th", { scope: "row" }, delivery.event), h("td", { class: "nowrap" }, when(delivery.created_at)),
    h("td", { class: "nowrap" }, deliveryMark(delivery.state)), h("td", { class: "n" }, number(delivery.attempts)),
    h("td", { class: "n" }, delivery.status === null ? "–" : String(delivery.status)), h("td", {}, told(delivery), delivery.answer && h("div", { class: "quiet" }, delivery.answer)),
    h("td", { class: "row-actions" }, button("Deliver again", () => deliver(webhook, at("webhooks", webhook.id, `/deliveries/${delivery.id}/again`)))));
}

async function showDeliveries(webhook) {
  looked = webhook.id;
  const rows = h("tbody"), more = h("div");
  const head = h("tr", {}, th("Event"), th("When"), th("State"), th("Tries", "n"), th("Status", "n"), th("What was said"), h("td", {}));
  const box = table(`Deliveries to ${webhook.url}`, head, []);
  box.querySelector("tbody").replaceWith(rows);
  await paged((cursor) => get(at("webhooks", webhook.id, `/deliveries${cursor ? `?cursor=${encodeURIComponent(cursor)}` : ""}`)),
    (items) => rows.append(...items.map((delivery) => deliveryRow(webhook, delivery))), more);
  show(byId("webhook-deliveries"), h("h3", {}, "Told to ", h("code", {}, webhook.url)),
    rows.children.length === 0 ? h("p", { class: "quiet" }, "Nothing yet.") : [box, more]);
  announce(`${rows.children.length} deliveries`);
}

function row(webhook) {
  const switched = async () => {
    await patch(at("webhooks", webhook.id), { active: !webhook.active });
    await showWebhooks();
  };
  return [
    h("tr", {},
      h("th", { scope: "row" }, h("code", {}, webhook.url), webhook.description && h("div", { class: "quiet" }, webhook.description)),
      h("td", {}, webhook.events.join(", ")),
      h("td", { class: "nowrap" }, webhookMark(webhook), webhook.failing_since && h("div", { class: "quiet" }, "since ", when(webhook.failing_since)))),
    h("tr", {}, h("td", { colSpan: 3, class: "row-actions" },
      button("Send a test", () => deliver(webhook, at("webhooks", webhook.id, "/test"))), button("Deliveries", () => showDeliveries(webhook)),
      button("Change…", () => edit(webhook)), button(webhook.active ? "Switch off" : "Switch on", switched),
      button("New secret…", () => renew(webhook)), button("Remove…", () => drop(webhook)))),
  ];
}

async function showList() {
  const { items } = await get("webhooks");
  show(byId("webhooks"), items.length === 0 ? h("p", { class: "quiet" }, "None yet.")
    : table("Webhooks", h("tr", {}, th("Address"), th("Told of"), th("State")), items.map(row)));
}

/** Show the fleet's webhooks, and nothing else of them any more. */
export async function showWebhooks() {
  looked = null;
  show(byId("webhook-secret"));
  show(byId("webhook-deliveries"));
  await showList();
}

byId("new-webhook").addEventListener("click", (event) => busy(event.currentTarget, add));
