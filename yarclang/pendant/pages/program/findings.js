// The findings of a program: code, message, help, and the fixes that the analyst offers.

import { button, h, put } from "/dom.js";

const MOST = 200;

const WORDS = { error: "Error", warning: "Warning", info: "Note", hint: "Note" };

export class Findings {
  constructor({ goTo, fix }) {
    this.list = h("ul", { class: "findings" });
    this.state = h("p", { class: "analyst-state" }, "The program is being checked …");
    this.place = h("div", { class: "found" }, this.state, this.list);
    this.goTo = goTo;
    this.fix = fix;
    this.all = [];
  }

  set(all) {
    this.all = all;
    this.said(all.length ? "" : "No findings.");
    put(this.list, all.slice(0, MOST).map((one) => this.made(one)));
    if (all.length > MOST) this.list.append(h("li", {}, `and ${all.length - MOST} more`));
  }

  made(one) {
    return h(
      "li",
      { class: one.severity, "data-line": one.line },
      button(`Line ${one.line}`, () => this.goTo(one.line), { class: "line" }),
      h("div", { class: "words" }, h("div", {}, h("strong", {}, `${WORDS[one.severity]} ${one.code}: `), one.message), one.help ? h("div", { class: "help" }, one.help) : null),
      one.fixes.length ? h("div", { class: "fixes" }, one.fixes.map((fix) => button(fix.title, () => this.fix(fix), { class: "fix" }))) : null,
    );
  }

  said(text) {
    this.state.textContent = text;
    this.state.hidden = !text;
  }

  // The worst severity of each line that has a finding.
  get marks() {
    const found = new Map();
    const worse = ["error", "warning", "info", "hint"];
    for (const one of this.all) {
      const known = found.get(one.line);
      if (!known || worse.indexOf(one.severity) < worse.indexOf(known)) found.set(one.line, one.severity);
    }
    return found;
  }

  // The worst severity of all findings; empty: there are none.
  get worst() {
    return ["error", "warning", "info", "hint"].find((severity) => this.all.some((one) => one.severity === severity)) ?? "";
  }
}
