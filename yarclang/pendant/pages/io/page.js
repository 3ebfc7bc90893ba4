// The page of inputs and outputs: their present values, switching of outputs, and setting of a simulated robot's
// inputs.

import { get } from "/api.js";
import { h, put, text } from "/dom.js";
import { Row, fitted, shownValue } from "/io/row.js";
import { Switching } from "/io/switching.js";

const EACH = 500; // time between two requests [ms]
const SOON = 60;
const ORDERS = {
  file: () => 0,
  name: (a, b) => a.signal.name.localeCompare(b.signal.name),
  variable: (a, b) => a.signal.variable.localeCompare(b.signal.variable, undefined, { numeric: true }),
};

export function ioPage(place, app) {
  style();
  const page = new Page(place, app);
  page.open();
  return () => page.close();
}

class Page {
  constructor(place, app) {
    Object.assign(this, { app, rows: [], version: "", told: null, values: null, at: 0, wanted: { kind: "all", sort: "file", ...app.recall("io") } });
    this.ending = new AbortController();
    this.switching = new Switching(app, () => this.soon());
    this.search = h("input", { type: "search", placeholder: "Search names", "aria-label": "Search names, variables and comments", oninput: () => this.sift() });
    this.waits = h("p", { class: "io-wait", role: "status", hidden: true });
    this.said = h("p", { class: "said" });
    this.lists = { input: h("ul", { class: "signals" }), output: h("ul", { class: "signals" }) };
    this.heads = { input: h("h2", {}, "Inputs"), output: h("h2", {}, "Outputs") };
    this.parts = Object.fromEntries(["input", "output"].map((kind) => [kind, h("section", { class: "io-part" }, this.heads[kind], this.lists[kind])]));
    this.other = this.switching.otherInput();
    this.parts.input.append(this.other);
    put(place,
      h("h1", { class: "hidden" }, "I/O"),
      h("div", { class: "io-bar" }, this.choice("Shown", "kind", [["all", "All"], ["input", "Inputs"], ["output", "Outputs"], ["on", "Not 0"]]), this.choice("Order", "sort", [["file", "As declared"], ["name", "Name"], ["variable", "Variable"]]), this.search),
      this.waits, this.said,
      h("div", { class: "io-lists" }, this.parts.input, this.parts.output));
  }

  choice(label, key, values) {
    const act = (value) => {
      this.wanted[key] = value;
      this.app.remember("io", this.wanted);
      this.sift();
    };
    if (key === "sort") {
      const made = h("select", { "aria-label": label, onchange: () => act(made.value) }, values.map(([value, shown]) => h("option", { value, selected: value === this.wanted[key] }, shown)));
      return made;
    }
    return h("fieldset", { class: "choice" }, h("legend", {}, label), values.map(([value, shown]) =>
      h("label", {}, h("input", { type: "radio", name: `io-${key}`, value, checked: value === this.wanted[key], onchange: () => act(value) }), h("span", {}, shown))));
  }

  open() {
    const { signal } = this.ending;
    const { robot } = this.app;
    for (const event of ["output_set", "input_changed", "wait_began", "wait_ended", "finished", "began"]) robot.addEventListener(event, () => this.soon(), { signal });
    for (const event of ["display", "lost", "found"]) robot.addEventListener(event, () => this.fit(), { signal });
    this.asking = setInterval(() => !document.hidden && this.ask(), EACH);
    this.ticking = setInterval(() => this.wait(), 200);
    this.ask();
  }

  // Request the values soon after an event. One request serves several events.
  soon() {
    this.hurry ??= setTimeout(() => {
      this.hurry = undefined;
      this.ask();
    }, SOON);
  }

  async ask() {
    if (this.busy) {
      this.again = true;
      return;
    }
    this.busy = true;
    try {
      const values = await get("/api/signals/values");
      if (values.version !== this.version) {
        this.told = await get("/api/signals");
        if (this.closed) return;
        this.version = this.told.version;
        this.draw();
      }
      if (values.version === this.version) this.take(values);
      this.trouble = "";
    } catch (refused) {
      this.trouble = refused.message;
      this.values = null;
      for (const row of this.rows) row.show(null, false, []);
    } finally {
      this.busy = false;
      if (!this.closed) {
        this.words();
        this.fit();
        if (this.again) {
          this.again = false;
          this.soon();
        }
      }
    }
  }

  draw() {
    this.rows = this.told.signals.map((signal) => new Row(signal, this.switching, this.told.fixed));
    this.switching.fixed = this.told.fixed;
    this.sift();
  }

  take(values) {
    this.values = values;
    this.at = performance.now();
    const heard = new Set(values.heard);
    const held = new Map(values.held.map(({ output, parts }) => [output, parts]));
    this.rows.forEach((row, number) => row.show(values.values[number], heard.has(number), held.get(row.signal.name) ?? []));
    if (this.wanted.kind === "on") this.sift();
    this.wait();
  }

  // Show the rows that match the search and the filter, in the chosen order.
  sift() {
    const word = this.search.value.trim().toLowerCase();
    const { kind, sort } = this.wanted;
    const fits = (row) => (!word || row.words.includes(word)) && (kind !== "on" || (row.value !== null && row.value !== 0));
    const found = this.rows.filter(fits).sort(ORDERS[sort] ?? ORDERS.file);
    for (const [one, list] of Object.entries(this.lists)) {
      const mine = found.filter(({ signal }) => signal.kind === one);
      const all = this.rows.filter(({ signal }) => signal.kind === one).length;
      fitted(list, mine.map(({ element }) => element), all ? "No input or output has this name or value." : `No ${one}s are declared: cell.toml names them under [${one}s].`);
      text(this.heads[one], `${one === "input" ? "Inputs" : "Outputs"}: ${mine.length === all ? all : `${mine.length} of ${all}`}`);
      this.parts[one].hidden = kind === "input" || kind === "output" ? kind !== one : false;
    }
  }

  wait() {
    const waiting = this.values?.waiting;
    this.waits.hidden = !waiting;
    if (!waiting) return;
    const since = Math.max(0, waiting.since_s + (performance.now() - this.at) / 1000);
    const known = waiting.value === null ? "its value is unknown" : `it is ${shownValue(waiting.value)}`;
    text(this.waits, `${waiting.place} waits for ${waiting.name} = ${shownValue(waiting.wanted)} since ${since < 60 ? `${since.toFixed(0)} s` : `${Math.floor(since / 60)} min ${Math.floor(since % 60)} s`}: ${known}.`);
    for (const row of this.rows) row.waited(row.signal.kind === "input" && row.signal.variable === waiting.variable);
  }

  words() {
    const said = [];
    if (this.trouble) said.push(`The values are unknown: ${this.trouble}.`);
    if (this.told?.fixed) said.push(`Values of a real controller are read while the robot is at rest; during a program they are the last ones that the program reported. Inputs can't be set here: ${this.told.fixed}.`);
    if (this.told?.trouble) said.push(`The cell's data is missing: ${this.told.trouble}`);
    text(this.said, said.join(" "));
    this.said.hidden = !said.length;
    if (!this.values?.waiting) for (const row of this.rows) row.waited(false);
  }

  // Enable the buttons that may be used now, and show the reason if none may be.
  fit() {
    const outputs = this.switching.whyNot("output");
    const inputs = this.switching.whyNot("input");
    for (const row of this.rows) row.fit(row.signal.kind === "output" ? outputs : inputs);
    this.switching.tell(this.parts, { output: outputs, input: this.told?.fixed ? "" : inputs });
    this.other.hidden = Boolean(this.told?.fixed ?? true) || inputs !== "";
  }

  close() {
    this.closed = true;
    this.ending.abort();
    clearInterval(this.asking);
    clearInterval(this.ticking);
    clearTimeout(this.hurry);
  }
}

function style() {
  if (document.querySelector("link[href='/io/io.css']")) return;
  document.head.append(h("link", { rel: "stylesheet", href: "/io/io.css" }));
}
