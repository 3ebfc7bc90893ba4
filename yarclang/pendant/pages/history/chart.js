// Plots of a run over time. One panel is shown at a time; the user chooses its lines, zooms by pinch, wheel or buttons,
// and reads values by touching the plot.

import { button, h, mark, put, text } from "/dom.js";
import { Drawing, colourOf } from "/history/drawing.js";

const LEAST = 0.05; // shortest time range of a plot [s]
const THINNED = 1900; // a line with more points than this has been thinned by the server

export class Chart {
  // `told`: content of the log (message RunShown). `on`: callbacks at(time) and window(from, to).
  constructor(told, on) {
    Object.assign(this, { told, on, time: 0, hidden: new Set(), fingers: new Map(), fine: null });
    this.whole = [0, Math.max(told.end_s, LEAST)];
    this.window = [...this.whole];
    this.panels = [...told.lines.map((one) => one.title), ...(told.signals.length ? ["Signals"] : [])];
    this.panel = this.panels[0] ?? "";
    this.canvas = h("canvas", { class: "chart", role: "img", tabindex: 0, "aria-label": "Plot over the time of the run" });
    this.choices = h("select", { class: "panels", "aria-label": "Plot", onchange: () => this.choose(this.choices.value) }, this.panels.map((name) => h("option", { value: name }, name)));
    this.legend = h("div", { class: "legend" });
    this.values = h("output", { class: "values" });
    const zoom = (label, name, act) => button(label, act, { "aria-label": name, title: name });
    this.zooms = h("div", { class: "zooms" },
      zoom("+", "Zoom in", () => this.zoom(0.5)), zoom("−", "Zoom out", () => this.zoom(2)),
      zoom("◀", "Earlier", () => this.pan(-0.5)), zoom("▶", "Later", () => this.pan(0.5)), button("All", () => this.look(...this.whole)));
    this.element = h("section", { class: "plots" }, h("div", { class: "plot-head" }, this.choices, this.zooms), this.legend, h("div", { class: "chart-frame" }, this.canvas), this.values);
    this.drawing = new Drawing(this.canvas);
    this.listen();
    this.choose(this.panel);
  }

  listen() {
    const { canvas } = this;
    this.watching = new ResizeObserver(() => this.draw());
    this.watching.observe(canvas);
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.redraw = () => this.draw();
    this.dark.addEventListener("change", this.redraw);
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, event.offsetX);
      if (this.fingers.size === 1) this.point(event.offsetX);
    });
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => this.fingers.delete(event.pointerId));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? 1.25 : 0.8, this.drawing.timeAt(event.offsetX));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const steps = { ArrowLeft: -1, ArrowRight: 1 };
      if (steps[event.key]) this.on.at(this.time + (steps[event.key] * (this.window[1] - this.window[0])) / 200);
    });
  }

  move(event) {
    const before = this.fingers.get(event.pointerId);
    if (before === undefined) {
      if (event.pointerType === "mouse") this.point(event.offsetX);
      return;
    }
    const others = [...this.fingers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
    this.fingers.set(event.pointerId, event.offsetX);
    if (!others.length) {
      this.point(event.offsetX);
      return;
    }
    const [was, is] = [Math.abs(before - others[0]), Math.abs(event.offsetX - others[0])];
    if (was > 8 && is > 8) this.zoom(was / is, this.drawing.timeAt((event.offsetX + others[0]) / 2));
  }

  point(x) {
    this.on.at(Math.max(this.whole[0], Math.min(this.whole[1], this.drawing.timeAt(x))));
  }

  // True if the server has more points of the visible time range than are shown.
  get isThinned() {
    return this.told.lines.some((one) => one.times.length > THINNED) && this.window[1] - this.window[0] < 0.9 * (this.whole[1] - this.whole[0]);
  }

  choose(name) {
    this.panel = name;
    const lines = this.told.lines.find((one) => one.title === name);
    put(this.legend, (lines?.names ?? []).map((label, index) => this.switch_(label, index)));
    this.draw();
  }

  switch_(label, index) {
    const made = button("", () => {
      if (!this.hidden.delete(index)) this.hidden.add(index);
      mark(made, "aria-pressed", String(!this.hidden.has(index)));
      this.draw();
    }, { "aria-pressed": String(!this.hidden.has(index)) });
    const sample = h("canvas", { class: "sample", width: 22, height: 6, "aria-hidden": "true" });
    const pen = sample.getContext("2d");
    pen.fillStyle = colourOf(index);
    pen.fillRect(0, 0, 22, 6);
    put(made, sample, label);
    return made;
  }

  zoom(factor, about = this.time) {
    const [from, to] = this.window;
    const middle = about >= from && about <= to ? about : (from + to) / 2;
    this.look(middle - (middle - from) * factor, middle + (to - middle) * factor);
  }

  pan(share) {
    const [from, to] = this.window;
    const step = share * (to - from);
    const kept = Math.max(this.whole[0] - from, Math.min(this.whole[1] - to, step));
    this.look(from + kept, to + kept);
  }

  look(from, to) {
    const [first, last] = this.whole;
    const span = Math.max(LEAST, Math.min(to - from, last - first));
    const begin = Math.max(first, Math.min(from, last - span));
    this.window = [begin, begin + span];
    this.draw();
    this.on.window(...this.window);
  }

  // Accept lines with more points for a time range.
  take(told, window) {
    this.fine = { told, window };
    this.draw();
  }

  show(time) {
    this.time = time;
    this.draw();
  }

  draw() {
    if (!this.element.isConnected || this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = null;
      this.paint();
    });
  }

  paint() {
    const { fine, window } = this;
    const isFine = fine && fine.window[0] <= window[0] + 1e-3 && fine.window[1] >= window[1] - 1e-3;
    const told = isFine ? fine.told : this.told;
    const lines = told.lines.find((one) => one.title === this.panel);
    const planned = this.panel === "Positions" ? told.planned : null;
    const shown = { lines, planned, signals: lines ? null : this.told.signals, states: this.told.states, hidden: this.hidden, window, time: this.time };
    const values = this.drawing.paint(shown);
    text(this.values, `${this.time.toFixed(2)} s   ${values.join("   ")}`);
  }

  close() {
    this.watching.disconnect();
    this.dark.removeEventListener("change", this.redraw);
    cancelAnimationFrame(this.waiting);
  }
}
