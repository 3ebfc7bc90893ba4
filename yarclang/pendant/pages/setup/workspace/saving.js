// Saving of a draft. Before it, the page shows the changes of the files, the programs that the draft breaks, and errors
// at the robot's present position.

import { get, post, remove } from "/api.js";
import { button, h, put } from "/dom.js";
import { compared } from "/program/comparing.js";
import { pinned } from "/service.js";

const EACH = 500; // time between two requests for the check's progress [ms]

export class Saving {
  constructor(page) {
    Object.assign(this, { page, app: page.app, sheet: page.sheet });
  }

  async open() {
    const { draft } = this.page;
    const message = draft.message();
    let files;
    try {
      ({ files } = await post("/api/workspace/draft", message));
    } catch (refused) {
      this.refused(refused);
      return;
    }
    if (!files.length) {
      this.app.notice("Nothing changes: the files contain these values already.");
      return;
    }
    const wrong = files.filter((one) => one.refused);
    const comparisons = files.map((one) => ({ one, ...compared(one.before.replaceAll("\r\n", "\n"), one.after.replaceAll("\r\n", "\n"), []) }));
    this.checked = h("div", { class: "checked", role: "status" });
    const content = [
      ...wrong.map((one) => h("p", { class: "why held-back" }, `${one.file} can't be saved: ${one.refused}`)),
      h("h3", {}, "Programs"), this.checked,
      ...comparisons.flatMap(({ one, host }) => [h("h3", {}, one.file), this.findings(one), host]),
    ];
    const may = this.app.may("service");
    const save = may && !wrong.length ? [["Save", () => this.save(message), "main"]] : [];
    if (!may) content.unshift(h("p", { class: "soft" }, "Saving needs the role service and the PIN."));
    this.sheet.open("Save the workspace", content, [...save, ["Back", () => {}]]);
    this.open_ = true;
    this.sheet.closed = () => {
      this.open_ = false;
      clearTimeout(this.waiting);
      for (const { close } of comparisons) close();
      if (this.running) remove("/api/workspace/check").catch(() => {});
    };
    if (wrong.length) put(this.checked, h("p", {}, "Not checked: the draft has errors."));
    else this.check(message);
  }

  findings({ findings }) {
    return findings.length ? h("ul", { class: "findings" }, findings.slice(0, 20).map((one) => h("li", { class: one.severity }, `${one.code} line ${one.line ?? "?"}: ${one.message}`))) : "";
  }

  async check(message) {
    try {
      this.show(await post("/api/workspace/check", message));
      this.look();
    } catch (refused) {
      put(this.checked, h("p", {}, `Not checked: ${refused.message}`), button("Try again", () => this.check(message)));
    }
  }

  look() {
    clearTimeout(this.waiting);
    this.waiting = setTimeout(async () => {
      if (!this.open_) return;
      const told = await get("/api/workspace/check").catch(() => null);
      if (told && this.open_) this.show(told);
      if (this.open_ && (!told || told.state === "running")) this.look();
    }, EACH);
  }

  show(told) {
    this.running = told.state === "running" && told.mine;
    const broken = told.programs.filter((one) => one.holds === false && one.held);
    const open = told.programs.filter((one) => one.holds === null || (one.holds === false && !one.held));
    const good = told.programs.filter((one) => one.holds).length;
    put(this.checked,
      told.state === "running" && h("div", { class: "cells" }, h("progress", { max: Math.max(told.of, 1), value: told.done }), h("span", {}, `${told.done} of ${told.of} ${told.file}`), button("Cancel", () => this.cancel())),
      told.state === "failed" && h("p", { class: "bad" }, `The check has failed: ${told.what}`),
      told.state === "cancelled" && h("p", {}, "The check was cancelled."),
      told.state === "done" && h("p", { class: broken.length ? "bad" : "" }, broken.length ? `${counted(broken.length)} can no longer be proved.` : good ? `${counted(good)} that ${good === 1 ? "uses" : "use"} these files can still be proved.` : "No program of the project uses these files."),
      told.standing.map((one) => h("p", { class: "bad" }, `At the robot's position: ${one}.`)),
      broken.length > 0 && h("ul", { class: "findings" }, broken.map((one) => h("li", { class: "error" }, h("strong", {}, one.file), ` could be proved before, but can't now: line ${one.line ?? "?"}, ${one.code}: ${one.message}`))),
      open.length > 0 && h("details", {}, h("summary", {}, `Not checked: ${counted(open.length)} that couldn't be proved before either, or took too long`),
        h("ul", { class: "findings" }, open.map((one) => h("li", {}, h("strong", {}, one.file), ` ${one.code} ${one.message}`)))));
  }

  async cancel() {
    const told = await this.app.tried(() => remove("/api/workspace/check"));
    if (told) this.show(told);
  }

  async save(message) {
    try {
      const saved = await pinned(this.app, () => post("/api/workspace/save", message));
      this.app.notice(saved.told);
      await this.page.load();
    } catch (refused) {
      this.refused(refused);
    }
  }

  refused(refused) {
    if (refused.code !== "changed") {
      if (refused.status !== 401) this.app.notice(refused.message, true);
      return;
    }
    this.app.notice("The file was changed meanwhile: your draft is based on the previous version.", true, button("Discard the draft and reload the file", ({ target }) => {
      target.closest(".notice").remove();
      this.page.load();
    }));
  }
}

function counted(count) {
  return count === 1 ? "1 program" : `${count} programs`;
}
