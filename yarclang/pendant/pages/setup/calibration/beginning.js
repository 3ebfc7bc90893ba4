// The start of a calibration: choice of one of three kinds, and the names that each kind needs.

import { button, h, put } from "/dom.js";
import { picture } from "/setup/calibration/pictures.js";

const KINDS = [
  ["tip", "Tool tip", "When a tool is new, was bent or changed: touch one fixed, pointed object four times, tilted to other sides."],
  ["frame", "Frame", "When a table, fixture or workpiece was moved: touch its origin, a point on x, and a point of the plane."],
  ["home", "Joint offsets", "When a motor or encoder was changed: bring joints to their marks."],
];
const SAMPLE = { tip: { kind: "tip", touches: [{}, {}] }, frame: { kind: "frame", touches: [{}, {}] }, home: { kind: "home", touches: [] } };

// `begin` is called with the request. `other`, another user's calibration, is shown above the choice.
export function beginning(app, begin, other) {
  const form = h("div", { class: "asked" });
  const cards = KINDS.map(([kind, title, when]) => {
    const card = button("", () => choose(kind), { class: "kind", "data-kind": kind, "aria-pressed": "false" });
    card.append(picture(SAMPLE[kind]), h("strong", {}, title), h("span", { class: "soft" }, when));
    return card;
  });

  function choose(kind) {
    for (const card of cards) card.setAttribute("aria-pressed", String(card.dataset.kind === kind));
    put(form, FORMS[kind](app, begin));
    form.scrollIntoView({ block: "nearest" });
    form.querySelector("input, select")?.focus({ preventScroll: true });
  }

  if (!app.may("programmer")) {
    for (const card of cards) card.disabled = true;
    put(form, h("p", { class: "hint" }, "Calibrating needs the role programmer; robot.toml and cell.toml are written by service users with their PIN."));
  }
  return h("section", { class: "beginning" }, other, h("h2", {}, "What is calibrated?"), h("div", { class: "kinds" }, cards), form);
}

const name = (label, list) => h("input", { name: "name", required: true, maxlength: 60, autocomplete: "off", autocapitalize: "characters", spellcheck: "false", placeholder: "name", "aria-label": label, list });

function asked(begin, wanted, ...fields) {
  return h("form", { class: "naming", onsubmit: (event) => { event.preventDefault(); begin(wanted()); } },
    h("div", { class: "fields" }, fields), h("div", { class: "actions" }, h("button", { type: "submit", class: "main" }, "Begin")));
}

const FORMS = {
  tip: (app, begin) => {
    const own = (app.about?.moving ?? []).map((one) => one.name).filter((one) => one !== "{FLANGE}");
    const input = name("Name of the tool's frame");
    const known = h("div", { class: "known" }, own.map((one) => button(one, () => { input.value = one.replace(/[{}]/g, ""); })));
    return asked(begin, () => ({ kind: "tip", name: input.value }), h("label", {}, "Frame of the tool: choose one, or enter a new name", input), known);
  },
  frame: (app, begin) => {
    const input = name("Name of the frame");
    const moving = (app.about?.moving ?? []).map((one) => one.name);
    const tool = h("select", { "aria-label": "Touches with" }, moving.map((one) => h("option", { value: one, selected: one === app.jog.moving }, one)));
    return asked(begin, () => ({ kind: "frame", name: input.value, tool: tool.value }), h("label", {}, "Name of the frame", input), h("label", {}, "Touched with the tip of", tool));
  },
  home: (app, begin) => {
    const rows = (app.about?.joints ?? []).map((joint) => {
      const on = h("input", { type: "checkbox", "aria-label": `${joint.name} has a mark` });
      const value = h("input", { type: "number", step: "any", value: 0, min: joint.lower, max: joint.upper, "aria-label": `${joint.name} at its mark, ${joint.unit}` });
      return { joint, on, value, element: h("div", { class: "mark-row" }, h("label", { class: "check" }, on, joint.name), value, h("span", { class: "soft" }, joint.unit)) };
    });
    const wanted = () => ({ kind: "home", marks: Object.fromEntries(rows.filter(({ on }) => on.checked).map(({ joint, value }) => [joint.name, Number(value.value)])) });
    const form = asked(begin, wanted, h("p", { class: "hint" }, "Joints at a mark, and their positions at the mark:"), h("div", { class: "marks" }, rows.map(({ element }) => element)));
    const ready = () => { form.querySelector(".main").disabled = !rows.some(({ on }) => on.checked); };
    form.addEventListener("change", ready);
    ready();
    return form;
  },
};
