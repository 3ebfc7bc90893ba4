// The page of one run: plots, events, replay in three dimensions, and download of the log.

import { get } from "/api.js";
import { button, h, mark, put, seconds, text } from "/dom.js";
import { address } from "/files/names.js";
import { Chart } from "/history/chart.js";
import { both, facts } from "/history/look.js";
import { Replay } from "/history/replay.js";

const TABS = [["plots", "Plots"], ["replay", "Replay"], ["events", "Events"]];
const FINER = 400; // time without zooming after which more points are requested [ms]

export class RunPage {
  constructor(place, app, folder, file) {
    Object.assign(this, { app, folder, file, time: 0 });
    this.said = h("p", { class: "soft ending", role: "status" }, "The log is being read.");
    this.tabs = h("div", { class: "tabs", role: "tablist", hidden: true }, TABS.map(([name, label]) => button(label, () => this.show(name), { role: "tab", class: "place", "data-tab": name })));
    this.body = h("div", { class: "run-body" });
    put(place,
      h("h1", { class: "hidden" }, "Run"),
      h("div", { class: "history-head" },
        h("a", { class: "press", href: "#/history/runs" }, "‹ Runs"), this.tabs,
        h("a", { class: "press", href: address("runs/download", `${folder}/${file}`), download: "" }, "Download"), this.said),
      this.body);
    this.begin();
  }

  async ask(window = null) {
    const query = window ? `?from=${window[0].toFixed(3)}&to=${window[1].toFixed(3)}` : "";
    return get(`${address("runs/show", `${this.folder}/${this.file}`)}${query}`);
  }

  look() {
    if (!this.told) this.begin();
  }

  async begin() {
    let told;
    try {
      told = await this.ask();
    } catch (refused) {
      if (!this.closed && refused.status !== 401) text(this.said, refused.message);
      return;
    }
    if (this.closed) return;
    this.told = told;
    text(this.said, `${told.program}: ${told.outcome}`);
    mark(this.said, "data-well", String(told.well));
    this.said.title = told.outcome;
    this.tabs.hidden = false;
    this.chart = new Chart(told, { at: (time) => this.at(time), window: (from, to) => this.finer(from, to) });
    this.parts = { plots: this.chart.element, events: this.events(), replay: h("div", { class: "replay-part" }) };
    this.show("plots");
  }

  show(name) {
    for (const tab of this.tabs.children) mark(tab, "aria-current", tab.dataset.tab === name ? "page" : "false");
    put(this.body, this.parts[name]);
    if (name === "replay" && !this.replay) this.replay = new Replay(this.parts.replay, this.app, this.told, (time) => this.at(time, this.replay));
    if (name === "plots") this.chart.draw();
    if (name !== "replay") this.replay?.pause();
    else this.replay.set(this.time);
  }

  // Show another time of the run in all views, except in the view `by` that has requested it.
  at(time, by = null) {
    this.time = time;
    this.chart?.show(time);
    if (by !== this.replay) this.replay?.set(time);
  }

  // Request more points when the user has stopped zooming.
  finer(from, to) {
    clearTimeout(this.waiting);
    if (!this.chart.isThinned) return;
    this.waiting = setTimeout(async () => {
      const found = await this.ask([from, to]).catch(() => null); // the thinned points stay visible until more points arrive
      if (found && !this.closed) this.chart.take(found, [from, to]);
    }, FINER);
  }

  events() {
    const { told } = this;
    const rows = told.events.map((one) => h("li", {}, button("", () => (this.at(one.time_s), this.show("plots")), { class: one.warning ? "open event warn" : "open event" })));
    rows.forEach((row, index) => put(row.firstChild, h("span", { class: "soft" }, `${told.events[index].time_s.toFixed(2)} s`), h("span", { class: "filename" }, told.events[index].text)));
    return h("section", { class: "history-list" },
      facts([
        ["Began", both(told.started)],
        ["Lasted", seconds(told.end_s)],
        ["Ended", told.outcome],
        ["Code", told.code],
        ["What to do", told.remedy],
        ["Robot", `${told.robot} at ${told.controller}${told.pace === 1 ? "" : `, ${told.pace} times as fast as real time`}`],
        ["Written by", `yarclang ${told.version}`],
        ["To be known", told.notes.join("\n")],
      ]),
      h("ul", { class: "run-list" }, rows, told.more_events ? h("li", { class: "empty" }, `And ${told.more_events} more: \`yarc replay\` shows them.`) : null));
  }

  close() {
    this.closed = true;
    clearTimeout(this.waiting);
    this.chart?.close();
    this.replay?.close();
  }
}
