// An input or output: its name, its value, and the buttons that switch it.

import { button, h, mark, put, text } from "/dom.js";

const DIGITS = 6;

// Time for which a value that was just set stays visible, even if older values still arrive [ms].
const JUST_SET = 900;

export function shownValue(value) {
  if (value === null) return "unknown";
  if (value === 1) return "ON";
  if (value === 0) return "OFF";
  return Math.abs(value) >= 1e6 ? value.toExponential(3) : String(Number(value.toPrecision(DIGITS)));
}

// Put elements into a list, unless it contains them already. If there are none, show the text `none`.
export function fitted(list, elements, none) {
  if (!elements.length) {
    if (list.textContent !== none || list.children.length !== 1) put(list, h("li", { class: "empty" }, none));
    return;
  }
  const same = elements.length === list.children.length && elements.every((one, at) => one === list.children[at]);
  if (!same) put(list, elements);
}

export class Row {
  // `switching` carries out the buttons' actions. `fixed` is the reason why inputs can't be set; empty: they can.
  constructor(signal, switching, fixed) {
    Object.assign(this, { signal, value: null, heard: false, parts: [], settled: 0, sensed: signal.sensor && !fixed });
    this.words = `${signal.name} ${signal.variable} ${signal.comment}`.toLowerCase();
    this.lamp = h("output", { class: "lamp" }, "…");
    this.more = h("span", { class: "soft signal-more" });
    this.keys = signal.kind === "output" || !fixed ? this.made(switching) : [];
    this.element = h("li", { class: "signal", "data-name": signal.name },
      h("div", { class: "signal-name" }, h("span", {}, h("strong", { class: "filename" }, signal.name), " ", h("span", { class: "soft" }, signal.variable)), this.more),
      this.lamp,
      this.keys.length > 0 && h("div", { class: "signal-keys", role: "group", "aria-label": `Switch ${signal.name}` }, this.keys));
    this.describe();
  }

  made(switching) {
    const key = (label, act, attributes) => button(label, act, { class: "switch", ...attributes });
    return [
      key("OFF", () => switching.set(this, 0), { "data-value": 0, "aria-label": `${this.signal.name} off` }),
      key("ON", () => switching.set(this, 1), { "data-value": 1, "aria-label": `${this.signal.name} on` }),
      key("123", () => switching.ask(this), { "aria-label": `${this.signal.name}: another value` }),
    ];
  }

  describe() {
    const { signal } = this;
    const words = [
      signal.comment,
      signal.safe !== null && `${shownValue(signal.safe)} at a stop`,
      signal.kind === "output" && signal.safe === null && signal.declared && !signal.comment && "stays at a stop",
      signal.grips_at !== null && `closes a gripper at ${shownValue(signal.grips_at)}`,
      signal.removes_at !== null && `takes parts away at ${shownValue(signal.removes_at)}`,
      this.sensed && "set by a sensor of the cell",
      !signal.declared && "not from the cell",
      this.parts.length && `holds ${this.parts.join(", ")}`,
      this.heard && "last value reported by the program",
    ];
    text(this.more, words.filter(Boolean).join(" · "));
  }

  // Show a value that the controller has confirmed.
  set(value) {
    this.settled = 0;
    this.show(value, false, this.parts);
    this.settled = performance.now() + JUST_SET;
  }

  show(value, heard, parts) {
    if (value !== this.value && performance.now() < this.settled) return;
    if (value !== this.value || this.lamp.textContent === "…") {
      this.value = value;
      text(this.lamp, shownValue(value));
      mark(this.lamp, "data-on", String(value !== null && value !== 0));
      for (const one of this.keys) if (one.dataset.value !== undefined) mark(one, "aria-pressed", String(Number(one.dataset.value) === value));
    }
    if (heard !== this.heard || parts.join() !== this.parts.join()) {
      Object.assign(this, { heard, parts });
      this.describe();
    }
  }

  fit(why) {
    for (const one of this.keys) if (one.disabled !== (why !== "")) one.disabled = why !== "";
  }

  waited(is) {
    if (this.isWaited === is) return;
    this.isWaited = is;
    mark(this.element, "data-waited", String(is));
  }
}
