// Forms from the server's description of their fields.

import { h } from "/dom.js";

const LISTS = new Set(["choice", "frame", "joints", "pose", "signal"]);

export class Fields {
  constructor(fields, id = "field") {
    this.fields = fields;
    this.inputs = fields.map((one, index) => input(one, `${id}-${index}`));
    this.place = h(
      "div",
      { class: "fields" },
      fields.map((one, index) => h("label", { class: one.kind === "text" ? "wide" : null }, h("span", {}, one.label, one.unit ? h("span", { class: "unit" }, ` ${one.unit}`) : null), this.inputs[index])),
    );
  }

  get all() {
    return Object.fromEntries(this.fields.map((one, index) => [one.name, value(this.inputs[index])]));
  }

  // The values that the user has changed.
  get changed() {
    return Object.fromEntries(Object.entries(this.all).filter(([name], index) => value(this.inputs[index]) !== String(this.fields[index].value ?? "") && name));
  }
}

const value = (place) => (place.querySelector?.("input, select") ?? place).value.trim();

function input(field, id) {
  const attributes = { name: field.name, value: String(field.value ?? ""), autocomplete: "off", spellcheck: "false" };
  const choices = [...(field.choices ?? [])];
  if (field.kind === "choice" && choices.length) {
    const given = String(field.value ?? "");
    if (!choices.includes(given)) choices.unshift(given);
    return h("select", { name: field.name }, choices.map((one) => h("option", { value: one, selected: one === given }, one || "–")));
  }
  if (LISTS.has(field.kind) && choices.length) {
    return h("span", { class: "listed" }, h("input", { ...attributes, list: id }), h("datalist", { id }, choices.map((one) => h("option", { value: one }))));
  }
  const number = field.kind === "number" || field.kind === "percent";
  return h("input", { ...attributes, inputmode: number ? "decimal" : null });
}
