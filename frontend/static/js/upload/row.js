/** One file on the upload page: how far it is, pause and go on, and what became of it. */

import { get, request, at } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { bytes, duration } from "../core/format.js";
import { announce, problemBox } from "../core/notify.js";
import { KIND_NAMES, isTable } from "./kind.js";
import { entryOf, forget, remember } from "./memory.js";
import { TusUpload } from "./tus.js";

const BUSY = new Set(["sending", "paused"]);

export class UploadRow {
  /** @param {File} file @param {string} kind @param {import("../jobs/job-feed.js").JobFeed} feed @param {(row: UploadRow) => void} changed */
  constructor(file, kind, feed, changed) {
    Object.assign(this, { file, kind, feed, changed, state: "ready", entry: kind === "trip" || kind === "elevation" ? entryOf(file) : null });
    this.status = h("span", { class: "quiet" });
    this.buttons = h("span");
    this.bar = h("progress", { max: 1, value: 0, ariaLabel: `${file.name} sent`, hidden: true });
    this.result = h("div");
    this.node = h("div", { class: "card upload-row" },
      h("div", { class: "line" }, h("span", { class: "name" }, file.name), h("span", { class: "tag" }, KIND_NAMES[kind]), this.status, this.buttons),
      this.bar, this.result);
    this.set("ready");
  }

  set(state) {
    this.state = state;
    const button = (word, action) => h("button", { class: "btn small", type: "button", on: { click: action } }, word);
    const offered = {
      ready: [button("Remove", () => this.drop())],
      sending: [button("Pause", () => this.pause())],
      paused: [button("Go on", () => this.send()), button("Give up", () => this.giveUp())],
      failed: [button("Try again", () => this.start(this.carId, this.mapping)), button("Remove", () => this.drop())],
    };
    show(this.buttons, offered[state] ?? []);
    this.bar.hidden = !BUSY.has(state);
    if (state === "ready") this.say(this.entry ? `${bytes(this.file.size)}, goes on where it stopped` : bytes(this.file.size));
    this.changed(this);
  }

  say(...words) {
    show(this.status, words);
  }

  /** Send the file for that car (null: it needs none); a mapping says what a table's columns mean. */
  async start(carId = null, mapping = null) {
    Object.assign(this, { carId, mapping });
    show(this.result);
    if (this.kind === "car") return this.makeCar();
    const trip = this.kind === "trip" ? { car_id: carId, mapping: isTable(this.file) ? mapping : null } : {};
    const metadata = this.entry?.metadata ?? { filename: this.file.name, kind: this.kind, ...trip };
    this.upload = new TusUpload(this.file, metadata, {
      url: this.entry?.url,
      created: (url) => remember(this.file, metadata, url),
      progress: (upload) => this.progress(upload),
    });
    return this.send();
  }

  /** Read a mapping, which is not sent by itself but with the tables; null when it is no JSON. */
  async readMapping() {
    try {
      const text = JSON.stringify(JSON.parse(await this.file.text()));
      this.say("used for the tables beside it");
      this.set("done");
      return text;
    } catch (error) {
      this.fail({ title: "This mapping is not JSON", detail: `${error.message}. Correct the file and drop it again.` });
      return null;
    }
  }

  /** Make a car of an XML file; the car's id is kept for the trips beside it. */
  async makeCar() {
    this.set("sending");
    try {
      const response = await request("cars", { method: "POST", headers: { "Content-Type": "application/xml" }, body: this.file });
      this.car = await response.json();
      this.say();
      show(this.result, h("p", {}, "New car: ", h("a", { href: `/cars/${this.car.id}` }, this.car.name)));
      this.set("done");
    } catch (error) {
      this.fail(error);
    }
  }

  async send() {
    this.set("sending");
    try {
      const upload = await this.upload.run();
      if (!upload) return;
      forget(this.upload.url);
      this.entry = null;
      await this.finish(upload);
    } catch (error) {
      this.fail(error);
    }
  }

  progress({ offset, rate, secondsLeft, waiting, file }) {
    this.bar.value = file.size ? offset / file.size : 1;
    const left = secondsLeft === null ? "" : `, ${duration(secondsLeft)} left`;
    if (waiting) this.say("No connection; goes on by itself when it is back");
    else this.say(`${bytes(offset)} of ${bytes(file.size)}`, rate > 0 && ` at ${bytes(rate)}/s${left}`);
  }

  pause() {
    this.upload?.pause();
    this.set("paused");
    this.say(`Paused at ${bytes(this.upload?.offset ?? 0)} of ${bytes(this.file.size)}`);
  }

  async giveUp() {
    await this.upload.forget().catch((error) => this.fail(error));
    forget(this.upload.url);
    this.drop();
  }

  drop() {
    this.node.remove();
    this.set("removed");
  }

  async finish(upload) {
    this.say(bytes(this.file.size));
    if (upload.problem || upload.state === "failed") {
      this.fail(upload.problem ?? { title: "The file arrived, but could not be used" });
      return;
    }
    const trip = upload.trip_ids?.[0];
    const link = trip && h("a", { href: `/trips/${trip}` }, "Open the trip");
    if (upload.duplicate) show(this.result, h("p", {}, "Ponthy has this very file already, so nothing was added. ", link));
    else if (this.kind === "elevation") show(this.result, h("p", {}, "The heights are in and will be used wherever they cover a trip. ", h("a", { href: "/settings" }, "All elevation tables")));
    else await this.follow(upload, link);
    announce(`${this.file.name} has arrived`);
    this.set("done");
  }

  async follow(upload, link) {
    if (!upload.job_id) {
      show(this.result, h("p", {}, link));
      return;
    }
    const view = this.feed.view(await get(at("jobs", upload.job_id)), { withTitle: false });
    view.node.classList.remove("card");
    show(this.result, view.node, link && h("p", {}, link));
  }

  fail(error) {
    show(this.result, problemBox(error));
    this.say(bytes(this.file.size));
    this.set("failed");
  }
}
