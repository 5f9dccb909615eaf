/** All cars, and a new one from an XML file or from the defaults. */

import { get, patch, post, at, query, sendXml } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { busy, guarded, problemBox } from "../core/notify.js";
import { countJobs } from "../core/shell.js";
import { closable, paged } from "../core/ui.js";
import { carCard } from "../lists/car-card.js";
import { droppable } from "../upload/drop.js";

const dialog = byId("new-car-dialog");
let chosen = null;

function choose(file) {
  chosen = file;
  byId("new-car-chosen").textContent = file ? `${file.name} will be read.`
    : "or drop it here. Without a file the car starts from the defaults and you fill in the form.";
}

function open() {
  choose(null);
  show(byId("new-car-problem"));
  byId("new-car-form").reset();
  dialog.showModal();
}

/** Make the car and go to its page. */
async function create() {
  const name = byId("new-car-name").value.trim();
  try {
    const car = chosen ? await sendXml("POST", "cars", await chosen.arrayBuffer()) : await post("cars", name ? { name } : {});
    if (chosen && name) await patch(at("cars", car.id), { name });
    location.assign(`/cars/${car.id}${chosen ? "" : "#file"}`);
  } catch (error) {
    show(byId("new-car-problem"), problemBox(error));
  }
}

function append(cars, first) {
  if (first && cars.length === 0) {
    show(byId("car-cards"), h("div", { class: "empty" }, h("h2", {}, "No cars yet"),
      h("p", {}, "A car is its XML file (mass, tyres, gears, sensors) and the trips it has driven."),
      h("div", { class: "actions" }, h("button", { class: "btn", on: { click: open } }, "Add the first car"), h("a", { class: "btn bare", href: "/" }, "Or see a demo car"))));
    return;
  }
  if (first) show(byId("car-cards"));
  byId("car-cards").append(...cars.map((car) => carCard(car, "h2")));
}

closable(dialog);
droppable(byId("new-car-drop"), byId("new-car-file"), ([file]) => choose(file));
byId("new-car").addEventListener("click", open);
byId("new-car-form").addEventListener("submit", (event) => {
  event.preventDefault();
  busy(event.submitter ?? byId("new-car"), create);
});
await guarded(() => Promise.all([paged((cursor) => get(`cars${query({ cursor })}`), append, byId("more")), countJobs()]));
