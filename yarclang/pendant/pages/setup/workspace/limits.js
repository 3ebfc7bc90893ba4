// The position limits of the joints in robot.toml.

import { button, h, put } from "/dom.js";
import { numberOf, shown } from "/setup/workspace/form.js";

export class Limits {
  constructor(draft, may) {
    Object.assign(this, { draft, may, place: h("section", { class: "limits", "aria-label": "Joint limits" }) });
  }

  show() {
    const { told, limits } = this.draft;
    if (!told || this.place.contains(document.activeElement) && this.told === told && document.activeElement.matches("input")) return;
    this.told = told;
    const can = this.may && !told.robot_why;
    put(this.place, h("h2", {}, "Joint limits"),
      told.robot_waits && h("p", { class: "why held-back" }, `${told.robot} differs from the version with which the robot is served: it takes effect after a restart, once the settings are sent.`),
      told.robot_why && h("p", { class: "soft" }, told.robot_why),
      told.joints.map((joint) => this.row(joint, limits[joint.name], can)),
      h("p", { class: "soft" }, "Changed limits take effect when the robot is served again and its settings are sent: System > Controller."));
  }

  row({ name, unit, lower, upper, least, largest }, changed, can) {
    const [low, high] = changed ?? [lower, upper];
    const inputs = [["lower", low, least], ["upper", high, largest]].map(([end, value, bound]) =>
      h("input", { type: "text", value: shown(value), disabled: !can || value === null, autocomplete: "off", "aria-label": `${name} ${end}`, title: bound === null ? end : `${end}; the URDF allows ${bound} ${unit}`, onchange: () => act() }));
    const act = () => {
      const pair = inputs.map((one) => numberOf(one.value));
      inputs.forEach((one, at) => one.toggleAttribute("aria-invalid", pair[at] === null));
      if (pair.includes(null)) return;
      this.draft.limit(name, pair[0] === lower && pair[1] === upper ? null : pair);
    };
    const allowed = least === null ? "" : `URDF ${shown(least)} to ${shown(largest)}`;
    return h("div", { class: changed ? "line changed" : "line" }, h("span", { class: "caption" }, `${name} [${unit}]`, allowed && h("small", {}, allowed)),
      h("div", { class: "cells" }, inputs, changed && button("Reset", () => this.draft.limit(name, null))));
  }
}
