// "Go there and look": a planned and proved motion to a touched point, which runs only while a button is held.

import { order, post } from "/api.js";
import { button, h, put } from "/dom.js";
import { holdable } from "/holding.js";
import { findings } from "/playback/facts.js";
import { nearest } from "/playback/player.js";

const TILTS = [["x", 15], ["x", -15], ["y", 15], ["y", -15]];

export class Looking {
  constructor(page) {
    Object.assign(this, { page, app: page.app });
    this.element = h("section", { class: "looking" });
    this.box = h("div", { class: "go" });
    this.said = h("p", { role: "status" });
    this.distance = h("input", { type: "number", min: 5, max: 500, step: 5, value: 50, "aria-label": "Distance, mm" });
    this.ending = new AbortController();
    const { signal } = this.ending;
    this.app.holding.addEventListener("told", (event) => this.hear(event.detail), { signal });
    this.app.holding.addEventListener("released", () => this.hear({ state: "ended", why: "" }), { signal });
  }

  draw(told) {
    put(this.box);
    this.button = null;
    this.element.hidden = told.kind === "home";
    const ways = told.kind === "tip"
      ? [["Back from the point", {}], ...TILTS.map(([axis, tilt]) => [`${tilt > 0 ? "+" : "−"}${Math.abs(tilt)}° about ${axis}`, { axis, tilt }])]
      : told.touches.map((one, at) => [`Above ${at < 2 ? one.label : `point ${at + 1}`}`, { at }]);
    this.ways = ways.map(([label, wanted]) => button(label, () => this.plan(wanted)));
    put(this.element, h("h2", {}, "Go there and look"),
      h("label", { class: "distance" }, "Distance (mm)", this.distance), h("div", { class: "actions ways" }, this.ways), this.box);
  }

  refresh() {
    const may = this.app.may("programmer") && this.app.controls;
    for (const one of this.ways ?? []) {
      one.disabled = !may;
      one.title = may ? "" : "Take control of the robot first.";
    }
  }

  async plan(wanted) {
    const { app, page } = this;
    app.holding.leave();
    this.button = null;
    put(this.said, "It is planned and proved.");
    put(this.box, this.said);
    const { version } = page.told;
    const told = await app.tried(async () => {
      const asked = { version, distance: Number(this.distance.value), ...wanted };
      const look = await post("/api/calibration/look", asked);
      return { look, ...(await order("offer", { text: look.text })) };
    });
    if (page.told?.version !== version || this.ending.signal.aborted) return;
    const { offer, look } = told ?? {};
    if (!offer) {
      put(this.said, told ? "No proved motion leads there." : "It couldn't be planned.");
      if (told) this.box.append(findings(told.findings));
      return;
    }
    put(this.said, `${look.what}. Proved: takes ${offer.duration_s.toFixed(1)} s${nearest(offer)}.`);
    this.button = button("Hold to go there", () => {}, { class: "main hold-to-go" });
    holdable(this.button, app.holding, "go", () => ({ go: offer.number }));
    put(this.box, this.button, this.said);
    this.button.scrollIntoView({ block: "nearest" });
  }

  hear({ state, why, help }) {
    if (!this.button?.isConnected) return;
    const told = why ? `${why}${help ? `: ${help}` : ""}.` : "";
    const rests = "The robot is at rest on its path: hold the button again to continue.";
    put(this.said, { moves: "It goes.", reached: "The robot is there: inspect the result." }[state] ?? (told || rests));
  }

  // End a motion that rests on its path, because its page is closed or changes.
  leave() {
    if (this.button) this.app.holding.leave();
    this.button = null;
  }

  close() {
    this.ending.abort();
    this.leave();
  }
}
