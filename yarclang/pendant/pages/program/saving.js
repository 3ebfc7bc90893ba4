// Saving: the changes are shown first. If somebody else has changed the file, the user chooses what to do.

import { h, put } from "/dom.js";
import { compared } from "/program/comparing.js";
import { pinned } from "/service.js";

export class Saving {
  constructor(page) {
    this.page = page;
    this.app = page.app;
  }

  show(title, before, after, buttons, said = null) {
    const { host, close } = compared(before, after, this.page.editor.coloured ?? []);
    this.page.sheet.open(title, [said && h("p", { class: "hint" }, said), host].filter(Boolean), buttons, "whole");
    this.page.sheet.closed = close;
  }

  save() {
    const { file, editor } = this.page;
    if (file.other) return this.conflict();
    this.show(`Save ${file.file}`, file.base, editor.text, [["Save", () => this.write(), "main"], ["Cancel"]]);
    return null;
  }

  async write(over) {
    const { file, editor } = this.page;
    const text = editor.text;
    try {
      await pinned(this.app, () => file.save(text, over));
      this.page.say(`${file.file} was saved.`);
      this.page.keep();
      put(this.page.warning);
    } catch (refused) {
      if (refused.code === "changed") {
        await file.look();
        if (file.other) this.conflict();
      } else this.app.notice(refused.status === 0 ? "The server can't be reached: nothing was saved. The draft is kept in this browser." : refused.message, true);
    }
    this.page.refresh();
  }

  // Show the three choices in the page. Until the user chooses one, nothing is lost.
  warn() {
    const { file, warning } = this.page;
    if (!file.other) {
      put(warning);
      return;
    }
    const what = file.other.gone ? "no longer exists on the disk" : "was changed on the disk meanwhile";
    put(warning, h("div", { class: "ask", role: "alert" }, h("span", {}, `${file.file} ${what}, and you have unsaved changes.`), h("div", { class: "actions" }, this.choices().map(([label, act]) => h("button", { type: "button", onclick: act }, label)))));
  }

  choices() {
    const { other } = this.page.file;
    const theirs = [
      ["Show the difference", () => this.conflict()],
      ["Take theirs", () => this.take()],
    ];
    return [...(other.gone ? [] : theirs), ["Write mine", () => this.write(other.sha256)]];
  }

  conflict() {
    const { file, editor } = this.page;
    this.warn();
    if (file.other.gone) return;
    const theirs = file.other.text.replace(/^\ufeff/, "").replace(/\r\n?/g, "\n");
    this.show(`${file.file}: theirs and mine`, theirs, editor.text, [["Take theirs", () => this.take()], ["Write mine", () => this.write(file.other?.sha256), "main"], ["Decide later"]], "Theirs is the file on the disk; mine is the text in this editor.");
  }

  take() {
    const { file, editor } = this.page;
    editor.become(file.take(file.other));
    put(this.page.warning);
    this.page.keep();
    this.page.refresh();
  }
}
