// The form for a zone or an obstacle. Its fields depend on the shape and the rule, as in cell.toml.

import { button, h, put } from "/dom.js";

const SHAPES = {
  obstacles: ["box", "sphere", "cylinder", "capsule"],
  zones: ["box", "sphere", "cylinder", "capsule", "half-space", "joints"],
};
const RULES = ["allowed", "forbidden", "slow", "posture"];
const SIZES = { box: ["size"], sphere: ["radius"], cylinder: ["radius", "length"], capsule: ["radius", "length"], mesh: ["file"], "half-space": ["normal"], joints: ["joints"] };
const EVERY = ["size", "radius", "length", "file", "normal", "joints"];
const AXES = ["x", "y", "z"];

export class EntryForm {
  constructor(draft, may) {
    this.draft = draft;
    this.may = may;
    this.place = h("div", { class: "entry", role: "group" });
  }

  // Show an entry by its key; null: none. If the fields stay the same, only their values are updated, so that the
  // edited field keeps the focus.
  show(key) {
    const item = key && this.draft.item(key);
    const form = item && JSON.stringify([key, item.table, item.values.shape, item.values.rule, Object.keys(item.values.joints ?? {}), Boolean(item.values.quat)]);
    if (form !== this.form) {
      this.form = form;
      this.key = key;
      this.fields = [];
      put(this.place, item ? this.build(item) : []);
    }
    for (const { input, read } of this.fields ?? []) {
      const value = item ? shown(read(this.draft.item(key).values)) : "";
      if (document.activeElement !== input && input.value !== value) input.value = value;
    }
  }

  build({ table, values, length_unit: length, angle_unit: angle, speed_unit: speed }) {
    const isZone = table === "zones";
    const shape = values.shape ?? "box";
    const placed = shape !== "joints";
    const shapes = values.shape === "mesh" ? ["mesh"] : SHAPES[table];
    return [
      this.line("Name", this.text("name", "Name")),
      isZone && this.line("Rule", this.choice("rule", RULES, "Rule", (rule) => this.rule(rule))),
      this.line("Shape", this.choice("shape", shapes, "Shape", (next) => this.shape(next))),
      placed && this.line("Frame", this.choice("frame", this.draft.told.frames.map(({ name }) => name), "Frame")),
      placed && this.line(`Place [${length || "?"}]`, AXES.map((axis, at) => this.number("xyz", axis, at, [0, 0, 0]))),
      placed && shape !== "half-space" && (values.quat
        ? this.line("Quaternion", ["x", "y", "z", "w"].map((axis, at) => this.number("quat", `quaternion ${axis}`, at, [0, 0, 0, 1])))
        : this.line(`Turned [${angle || "?"}]`, ["roll", "pitch", "yaw"].map((axis, at) => this.number("rpy", axis, at, [0, 0, 0])))),
      shape === "box" && this.line(`Edges [${length || "?"}]`, AXES.map((axis, at) => this.number("size", `edge ${axis}`, at, [100, 100, 100]))),
      SIZES[shape]?.includes("radius") && this.line(`Radius [${length || "?"}]`, this.number("radius", "radius")),
      SIZES[shape]?.includes("length") && this.line(`Length [${length || "?"}]`, this.number("length", "length")),
      shape === "half-space" && this.line("Normal, into it", AXES.map((axis, at) => this.number("normal", `normal ${axis}`, at, [0, 0, 1]))),
      shape === "mesh" && this.line("Mesh", h("span", {}, values.file ?? "")),
      placed && this.line(`Margin [${length || "?"}]`, this.number("margin", "margin")),
      values.rule === "slow" && this.line(`Speed [${speed || "?"}]`, this.number("speed", "speed")),
      isZone && placed && this.line("Watches", this.watch()),
      (shape === "joints" || values.rule === "posture") && this.windows(angle),
    ].filter(Boolean);
  }

  line(label, fields) {
    return h("div", { class: "line" }, h("span", { class: "caption" }, label), h("div", { class: "cells" }, fields));
  }

  field(input, read) {
    input.disabled = !this.may;
    this.fields.push({ input, read });
    return input;
  }

  text(name, label) {
    return this.field(h("input", { type: "text", name, maxlength: 60, autocomplete: "off", spellcheck: "false", "aria-label": label, onchange: ({ target }) => this.draft.set(this.key, { [name]: target.value.trim() }) }), (values) => values[name]);
  }

  choice(name, choices, label, act = (value) => this.draft.set(this.key, { [name]: value })) {
    const own = this.draft.item(this.key).values[name];
    const known = own && !choices.includes(own) ? [own, ...choices] : choices;
    return this.field(h("select", { name, "aria-label": label, onchange: ({ target }) => act(target.value) }, known.map((one) => h("option", { value: one }, one))), (values) => values[name]);
  }

  // Return a field for one number: the value of a key, or element `at` of a list.
  number(name, label, at = null, first = null) {
    const read = (values) => (at === null ? values[name] : (values[name] ?? first)[at]);
    const act = ({ target }) => {
      const value = numberOf(target.value);
      if (value === null && (at !== null || target.value.trim() !== "")) {
        target.setAttribute("aria-invalid", "true");
        return;
      }
      target.removeAttribute("aria-invalid");
      if (at === null) {
        this.draft.set(this.key, { [name]: value ?? undefined });
        return;
      }
      const all = [...(this.draft.item(this.key).values[name] ?? first)];
      all[at] = value;
      this.draft.set(this.key, { [name]: all });
    };
    return this.field(h("input", { type: "text", inputmode: "text", name: at === null ? name : `${name}${at}`, autocomplete: "off", "aria-label": label, title: label, onchange: act }), read);
  }

  watch() {
    const { watch } = this.draft.told;
    const act = ({ target }) => {
      const names = target.value.split(",").map((one) => one.trim()).filter(Boolean);
      this.draft.set(this.key, { watch: names.length ? names : undefined });
    };
    return this.field(h("input", { type: "text", name: "watch", autocomplete: "off", spellcheck: "false", placeholder: "tool", title: `One or more of ${watch.join(", ")}`, "aria-label": "Watches", onchange: act }), (values) => values.watch?.join(", "));
  }

  // Return fields for the smallest and the largest value of each joint.
  windows(angle) {
    const { joints } = this.draft.told;
    return h("div", { class: "windows" }, joints.map(({ name, unit }) => this.line(`${name} [${unit === "mm" ? "mm" : angle || "?"}]`, ["least", "largest"].map((end, at) => this.end(name, end, at)))));
  }

  end(joint, end, at) {
    const act = ({ target }) => {
      const all = { ...this.draft.item(this.key).values.joints };
      const other = target.closest(".cells").querySelectorAll("input")[1 - at];
      const pair = at === 0 ? [numberOf(target.value), numberOf(other.value)] : [numberOf(other.value), numberOf(target.value)];
      if (pair.includes(null) && (target.value.trim() || other.value.trim())) return; // the other bound isn't entered yet
      if (pair.includes(null)) delete all[joint];
      else all[joint] = pair;
      this.draft.set(this.key, { joints: all });
    };
    return this.field(h("input", { type: "text", autocomplete: "off", "aria-label": `${joint} ${end}`, title: end, onchange: act }), (values) => values.joints?.[joint]?.[at]);
  }

  // Change the shape, with default sizes for the new shape.
  shape(shape) {
    const unit = this.draft.item(this.key).metre ?? 0.001;
    const size = Number((0.2 / unit).toPrecision(6));
    const first = { size: [size, size, size], radius: size / 2, length: size, normal: [0, 0, 1], joints: {} };
    const kept = this.draft.item(this.key).values;
    const values = Object.fromEntries(EVERY.map((key) => [key, SIZES[shape].includes(key) ? kept[key] ?? first[key] : undefined]));
    if (kept.rule === "posture") values.joints = kept.joints ?? {};
    if (shape === "joints") Object.assign(values, { frame: undefined, xyz: undefined, rpy: undefined, quat: undefined, margin: undefined, watch: undefined });
    else if (!kept.frame) values.frame = "B";
    if (shape === "half-space") Object.assign(values, { rpy: undefined, quat: undefined });
    this.draft.set(this.key, { shape, ...values });
  }

  rule(rule) {
    const { values, metre } = this.draft.item(this.key);
    const speed = rule === "slow" ? values.speed ?? Number((0.25 / (metre ?? 0.001)).toPrecision(6)) : undefined;
    const joints = rule === "posture" || values.shape === "joints" ? values.joints ?? {} : undefined;
    this.draft.set(this.key, { rule, speed, joints });
  }
}

export function numberOf(text) {
  const value = text.trim() === "" ? NaN : Number(text.trim().replace(",", "."));
  return Number.isFinite(value) && Math.abs(value) <= 1e9 ? value : null;
}

export function shown(value) {
  if (typeof value === "number") return String(Number(value.toPrecision(10)));
  return value ?? "";
}

// Return the buttons for a chosen entry.
export function acts(draft, key, choose) {
  return h("div", { class: "actions" },
    button("Duplicate", () => choose(draft.copy(key))),
    button("Remove", () => (draft.remove(key), choose(null))));
}
