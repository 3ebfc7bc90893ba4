// The list of the project's programs, from which the user chooses one.

import { get } from "/api.js";
import { button, h, put } from "/dom.js";

export class Choosing {
  constructor(app, player) {
    this.app = app;
    this.player = player;
    this.programs = [];
    this.list = h("ul", { class: "programs" });
    this.search = h("input", { type: "search", placeholder: "Search programs", "aria-label": "Search programs", oninput: () => this.draw() });
    this.element = h("section", { class: "list choosing" }, this.search, this.list);
  }

  async look() {
    const told = await this.app.tried(() => get("/api/programs"));
    this.known = Boolean(told);
    this.programs = told?.programs ?? [];
    this.draw();
  }

  draw() {
    const may = this.app.may("operator");
    const wanted = this.search.value.toLowerCase();
    const found = this.programs.filter((one) => one.file.toLowerCase().includes(wanted));
    // the program that was edited last comes first
    const { file: edited } = this.app.recall("program");
    const shown = [...found.filter((one) => one.file === edited), ...found.filter((one) => one.file !== edited)];
    const none = this.programs.length ? "No program has this name." : "The project has no program: create one on the page Program.";
    const words = !this.known ? "The list of programs is unknown." : !shown.length ? none : may ? "" : "Running programs needs the role operator.";
    put(this.list,
      words && h("li", { class: "empty" }, words),
      shown.map((one) => h("li", {}, button(one.file, () => this.player.load(one.file), { disabled: !may, class: one.file === edited ? "main" : null }))));
  }
}
