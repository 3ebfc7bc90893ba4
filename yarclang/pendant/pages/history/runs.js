// The page History > Runs: the list of run logs, and a page for each log.

import { get } from "/api.js";
import { button, h, put, seconds, text } from "/dom.js";
import { sized } from "/files/names.js";
import { local, style } from "/history/look.js";
import { RunPage } from "/history/run.js";

const MOST_SHOWN = 200;
const STATES = { "under way": ["warn", "under way"], "cut off": ["warn", "cut off"], unreadable: ["done", "no log of a run"] };

export const hashOf = (one) => `#/history/runs/${[one.place, ...one.file.split("/")].map(encodeURIComponent).join("/")}`;

// Return the style of a run's badge, and the end of the run in words.
export function endOf(one) {
  if (one.state !== "whole") return STATES[one.state];
  if (one.well === null) return ["warn", "end not known"];
  return one.well ? ["well", "came to its end"] : [one.code ? "holds" : "warn", one.what || "ended early"];
}

class List {
  constructor(place, app) {
    this.app = app;
    this.runs = [];
    this.search = h("input", { type: "search", placeholder: "Search runs", "aria-label": "Search runs", oninput: () => this.draw() });
    this.told = h("p", { class: "soft told-of", role: "status" }, "Searching for logs.");
    this.list = h("ul", { class: "run-list" });
    put(place,
      h("h1", { class: "hidden" }, "Runs"),
      h("div", { class: "history-head" }, h("div", { class: "finder" }, this.search), this.told, button("Look again", () => this.look())),
      h("section", { class: "history-list" }, this.list));
    this.look();
  }

  async look() {
    const told = await this.app.tried(() => get("/api/runs"));
    if (this.closed || !told) return;
    this.runs = told.runs;
    text(this.told, `${told.runs.length} logs${told.cut ? ", the newest of more" : ""}${told.folder ? `; new ones: ${told.folder}` : ""}`);
    this.draw();
  }

  draw() {
    const wanted = this.search.value.trim().toLowerCase();
    const found = this.runs.filter((one) => `${one.file} ${one.program} ${one.client} ${one.what} ${one.code}`.toLowerCase().includes(wanted));
    put(this.list, found.slice(0, MOST_SHOWN).map((one) => this.row(one)));
    if (found.length > MOST_SHOWN) this.list.append(h("li", { class: "empty" }, `And ${found.length - MOST_SHOWN} more: search for them.`));
    if (!found.length) put(this.list, h("li", { class: "empty" }, this.runs.length ? "No run has this name." : "There is no log yet: `yarc pendant` writes one with each run, unless --no-log is given."));
  }

  row(one) {
    const [kind, words] = endOf(one);
    const about = [one.client && `by ${one.client}`, one.duration_s === null ? "" : seconds(one.duration_s), sized(one.size)].filter(Boolean).join(",  ");
    return h("li", { "data-run": one.file }, h("button", { type: "button", class: "open", onclick: () => (location.hash = hashOf(one)) },
      h("span", { class: "run-when" }, local(one.started || one.changed)),
      h("span", { class: "filename" }, one.program || one.file),
      h("span", { class: `badge ${kind}` }, one.code ? `${one.code}  ${words}` : words),
      h("span", { class: "soft" }, about)));
  }

  close() {
    this.closed = true;
  }
}

export function runsPage(place, app, rest) {
  style();
  const [folder, ...path] = rest.split("/");
  const page = path.length ? new RunPage(place, app, folder, path.join("/")) : new List(place, app);
  app.whenBack(() => page.look());
  return () => page.close();
}
