// Writing of the result: choice of the file, the difference and its findings, then the file itself.

import { get, post } from "/api.js";
import { button, h, put } from "/dom.js";
import { pinned } from "/service.js";

const TARGETS = {
  tip: [["robot", "robot.toml"], ["program", "Program"]],
  frame: [["cell", "cell.toml"], ["program", "Program"]],
  home: [["robot", "robot.toml"]],
};

export class Writing {
  constructor(page) {
    Object.assign(this, { page, app: page.app });
    this.element = h("section", { class: "writing" });
    this.file = h("select", { "aria-label": "Program" });
    this.parent = h("select", { "aria-label": "Frame to which it is attached" });
  }

  draw(told) {
    const targets = TARGETS[told.kind];
    const choices = { program: () => this.choose(), cell: () => this.hang(), robot: () => this.propose({ to: "robot" }) };
    put(this.element, h("h2", {}, "Write it"),
      h("div", { class: "actions" }, targets.map(([to, label]) => button(`Into ${label === "Program" ? "a program" : label}`, choices[to]))),
      this.said = h("p", { class: "hint", role: "status" }));
  }

  async choose() {
    const told = await this.app.tried(() => get("/api/programs"));
    if (!told) return;
    put(this.file, told.programs.map(({ file }) => h("option", { value: file }, file)));
    const { sheet } = this.page;
    if (!told.programs.length) {
      sheet.open("A FRAME line", h("p", {}, "The project has no program."), [["Close"]], "small");
      return;
    }
    sheet.open("A FRAME line of which program?", this.file, [["Show the change", () => this.propose({ to: "program", file: this.file.value }), "main"], ["Cancel"]], "small");
  }

  // Ask for the parent of the frame in the cell. A frame moves with its parent, for example a fixture with its table.
  hang() {
    const fixed = (this.app.about?.fixed ?? []).map(({ name }) => name).filter((name) => name !== `{${this.page.told.name}}`);
    if (fixed.length < 2) {
      this.propose({ to: "cell" });
      return;
    }
    put(this.parent, fixed.map((name) => h("option", { value: name, selected: name === "{B}" }, name)));
    const hint = h("p", { class: "hint" }, "It moves with this frame. A frame that the cell already has keeps its parent.");
    this.page.sheet.open("To which frame is it attached?", [this.parent, hint], [["Show the change", () => this.propose({ to: "cell", parent: this.parent.value }), "main"], ["Cancel"]], "small");
  }

  async propose(wanted) {
    const asked = { version: this.page.told.version, ...wanted };
    try {
      this.show(asked, await post("/api/calibration/propose", asked));
    } catch (refused) {
      if (refused.code !== "exists") {
        this.refused(refused);
        return;
      }
      const replace = await this.page.sheet.ask("It exists already", h("p", {}, `${refused.message}.`), [["Replace it", true, "main"], ["Cancel", false]]);
      if (replace) this.propose({ ...wanted, replace });
    }
  }

  async show(asked, made) {
    const { compared } = await import("/program/comparing.js");
    const { host, close } = compared(made.before.replaceAll("\r\n", "\n"), made.after.replaceAll("\r\n", "\n"), []);
    const service = asked.to !== "program";
    const may = !made.obstacle && this.app.may(service ? "service" : "programmer");
    const content = [
      h("p", {}, `${made.what[0].toUpperCase()}${made.what.slice(1)}.`),
      made.obstacle && h("p", { class: "why held-back" }, made.obstacle),
      !made.obstacle && !may && h("p", { class: "why held-back" }, "Writing it needs the role service and the PIN."),
      made.findings.length > 0 && h("ul", { class: "findings" }, made.findings.slice(0, 20).map((one) => h("li", { class: one.severity }, `${one.code} line ${one.line ?? "?"}: ${one.message}`))),
      host,
      h("p", { class: "hint" }, `Afterwards: ${made.then}. The previous file is kept in Files > Deleted.`),
    ].filter(Boolean);
    if (asked.to === "program") content.at(-1).textContent = `Afterwards: ${made.then}.`;
    const { sheet } = this.page;
    sheet.open(`Write ${made.file}`, content, may ? [["Write", () => this.write(asked, made.known), "main"], ["Cancel"]] : [["Close"]], "whole");
    sheet.closed = close;
  }

  async write(asked, known) {
    try {
      const told = await pinned(this.app, () => post("/api/calibration/write", { ...asked, known }));
      put(this.said, `${told.file} was written. Next: ${told.then}.`);
      this.app.notice(`${told.file} was written.`);
    } catch (refused) {
      this.refused(refused);
    }
  }

  refused(refused) {
    if (refused.status !== 401) this.app.notice(refused.message, true);
    if (["changed", "gone"].includes(refused.code)) this.page.ask();
  }
}
