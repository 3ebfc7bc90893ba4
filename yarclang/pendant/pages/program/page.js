// The page Program: the program as a list of commands and as text. A change or selection in one is shown in the other.

import { post } from "/api.js";
import { button, h, mark, put, text } from "/dom.js";
import { Analyst } from "/program/analyst.js";
import { Changing } from "/program/changing.js";
import { begin, choose } from "/program/choosing.js";
import { Editor } from "/program/editor.js";
import { ProgramFile } from "/program/file.js";
import { Findings } from "/program/findings.js";
import { language } from "/program/language.js";
import { Rows } from "/program/rows.js";
import { Saving } from "/program/saving.js";
import { Sheet } from "/program/sheet.js";

const PAUSE = 300; // time from the last change until the list and the draft are updated [ms]
const TABS = [["list", "List"], ["text", "Text"], ["found", "Findings"]];

class ProgramPage {
  constructor(place, app) {
    this.app = app;
    this.mayEdit = app.may("programmer");
    this.rows = new Rows();
    this.findings = new Findings({ goTo: (line) => this.goToLine(line), fix: (fix) => this.fix(fix) });
    this.changing = new Changing(this);
    this.saving = new Saving(this);
    this.ending = new AbortController();
    this.lay(place);
    this.editor = new Editor(this.host, { editable: this.mayEdit });
    const { signal } = this.ending;
    this.editor.addEventListener("changed", () => this.changed());
    this.editor.addEventListener("selected", () => this.follow());
    this.rows.addEventListener("chosen", () => this.chosen());
    app.robot.addEventListener("display", () => this.run(), { signal });
    window.addEventListener("pagehide", () => this.keep(), { signal });
    window.addEventListener("beforeunload", (event) => this.isChanged && event.preventDefault(), { signal });
    language().then((made) => !this.closed && this.editor.colour(made));
  }

  // layout

  lay(place) {
    this.title = button("", () => choose(this), { class: "file", title: "Choose a program" });
    this.saveButton = button("Save", () => this.saving.save(), { class: "main" });
    this.undoButton = button("Undo", () => this.editor.undo(), { "aria-keyshortcuts": "Control+Z" });
    this.redoButton = button("Redo", () => this.editor.redo(), { "aria-keyshortcuts": "Control+Y" });
    this.more = button("More", () => this.showMore());
    this.tabs = h("div", { class: "tabs", role: "tablist" }, TABS.map(([name, label]) => button(label, () => this.show(name), { role: "tab", "data-tab": name })));
    this.warning = h("div", { class: "warnings" });
    this.host = h("div", { class: "text", "data-part": "text" });
    this.did = h("p", { class: "did", role: "status", hidden: true });
    this.viaShown = h("div", { class: "via", hidden: true }, h("span", {}, "A via point is recorded. Jog to the end of the arc, then teach a MOVEC here."), button("Drop it", () => this.changing.dropVia()));
    const { changing } = this;
    this.acts = [
      ["Teach here", () => changing.teach(), "main", () => true],
      ["Touch up", () => changing.touchUp(), "", (rows) => rows.length === 1 && rows[0].taught],
      ["Insert", () => changing.insert(), "", () => true],
      ["Edit", () => changing.edit(), "", (rows) => rows.length === 1 && rows[0].fields.length > 0],
      ["▲", () => changing.move(-1), "arrow", (rows) => rows.length === 1 && this.rows.first > 0, "Move up"],
      ["▼", () => changing.move(1), "arrow", (rows) => rows.length === 1 && this.rows.last < this.rows.commands.length - 1, "Move down"],
      ["Delete", () => changing.remove(), "", (rows) => rows.length > 0],
    ].map(([label, act, look, may, name]) => ({ may, button: button(label, () => this.busy(act), { class: look || null, "aria-label": name ?? null, title: name ?? null }) }));
    this.bar = h("div", { class: "actions edits", hidden: !this.mayEdit }, this.acts.map((one) => one.button));
    const found = h("section", { class: "findings-part", "data-part": "found", "aria-label": "Findings" }, this.findings.place);
    const list = h("section", { class: "list-part", "data-part": "list", "aria-label": "Commands" }, this.rows.place);
    this.tools = h("div", { class: "tools" }, this.mayEdit ? [this.saveButton, this.undoButton, this.redoButton, this.more] : h("span", { class: "soft" }, "Editing needs the role programmer."));
    this.place = h("div", { class: "program" }, h("div", { class: "head" }, this.title, this.tabs, this.tools), this.warning, this.viaShown, h("div", { class: "parts" }, list, h("section", { class: "text-part", "data-part": "text" }, this.host), found), this.did, this.bar);
    this.sheet = new Sheet(this.place);
    put(place, h("h1", { class: "hidden" }, "Program"), this.place);
    this.show(this.app.recall("program").tab ?? "list");
  }

  show(name) {
    this.app.remember("program", { ...this.app.recall("program"), tab: name });
    mark(this.place, "data-shown", name);
    for (const tab of this.tabs.children) mark(tab, "aria-selected", String(tab.dataset.tab === name));
  }

  showMore() {
    const act = (label, work) => button(label, () => (this.sheet.close(), work()), { class: "pick" });
    const picks = [
      act("Renumber the commands", () => this.changing.renumber()),
      act("Format the text", () => this.format()),
      act("Declare the robot's pose under a name", () => this.changing.declare("pose")),
      act("Declare a frame at the robot's pose", () => this.changing.declare("frame")),
      act("Declare the joint position under a name", () => this.changing.declare("joints")),
      act("Show the changes", () => this.saving.save()),
      act("Undo all changes", () => this.editor.become(this.file.base)),
    ];
    this.sheet.open("More", h("div", { class: "picks" }, picks), [["Cancel"]]);
  }

  // Show a message about a change in its own line: a notice would cover the buttons.
  say(what) {
    text(this.did, what);
    this.did.hidden = false;
    clearTimeout(this.saying);
    this.saying = setTimeout(() => (this.did.hidden = true), 5000);
  }

  // the file

  async open(name) {
    this.app.remember("program", { ...this.app.recall("program"), file: name });
    this.file = new ProgramFile(this.app, name);
    const told = await this.app.tried(() => this.file.open());
    if (this.closed) return;
    if (told === null) {
      this.nothing(`${name} can't be opened.`);
      return;
    }
    this.opened = true;
    const { draft } = this.file;
    const { left } = this.app;
    const text = draft && this.mayEdit ? draft.text : told;
    const isSame = left?.file === name && left.state.doc === text;
    this.editor.open(isSame ? text : told, isSame ? left.state : null);
    if (draft && this.mayEdit) this.restore(draft);
    if (left?.file === name) this.editor.select(...left.lines);
    this.file.addEventListener("other", () => this.changedOutside());
    this.file.addEventListener("same", () => this.saving.warn());
    if (this.mayEdit) this.analyse();
    else this.findings.said("Findings need the role programmer.");
    this.listSoon(0);
    this.refresh();
  }

  restore(draft) {
    this.editor.become(draft.text);
    this.say("Unsaved changes were restored.");
    if (draft.sha === this.file.sha) return;
    // the draft is based on an older version, so the file on the disk counts as somebody else's
    this.file.other = { sha256: this.file.sha, text: this.file.base };
    this.file.sha = draft.sha;
    this.saving.warn();
  }

  changedOutside() {
    const { file, editor } = this;
    if (this.isChanged || file.other.gone) {
      this.saving.warn();
      return;
    }
    editor.become(file.take(file.other));
    this.say(`${file.file} was changed on the disk, and was reloaded.`);
    this.refresh();
  }

  nothing(said) {
    this.opened = false;
    put(this.place, h("section", { class: "no-program" }, h("p", {}, said), h("div", { class: "actions" }, button("Choose a program", () => choose(this), { class: "main" }), this.mayEdit && button("New program", () => begin(this)))), this.sheet.place);
  }

  get isChanged() {
    return Boolean(this.opened) && this.mayEdit && this.editor.text !== this.file.base;
  }

  keep() {
    if (!this.opened || !this.mayEdit) return;
    if (!this.file.keep(this.editor.text) && !this.warned) this.warned = this.app.notice("This browser can't keep a draft of the program: save it soon.", true);
  }

  // the text and the list

  changed() {
    if (!this.opened) return;
    this.listSoon();
    clearTimeout(this.keeping);
    this.keeping = setTimeout(() => this.keep(), PAUSE);
    this.refresh();
  }

  // Schedule an update of the list. It is less frequent for a long program, whose list takes the server longer.
  listSoon(pause = Math.max(PAUSE, 2 * (this.took ?? 0))) {
    clearTimeout(this.listing);
    this.listing = setTimeout(() => this.list(), pause);
  }

  async list() {
    clearTimeout(this.listing);
    const { doc } = this.editor;
    const began = performance.now();
    let told;
    try {
      told = await post("/api/program/list", { file: this.file.file, text: doc.toString() });
    } catch (refused) {
      mark(this.rows.place, "data-old", "true");
      if (refused.status !== 0 && !this.closed) this.app.notice(`The list is out of date: ${refused.message}`, true);
      return;
    }
    this.took = performance.now() - began;
    if (this.closed || doc !== this.editor.doc) return;
    mark(this.rows.place, "data-old", "false");
    this.listed = doc;
    this.rows.set(told.commands);
    this.follow();
    this.run();
  }

  // Show the rows of the lines that are selected in the text.
  follow() {
    if (!this.choosing) this.rows.follow(...this.editor.lines);
    this.refresh();
  }

  chosen() {
    const rows = this.rows.selected;
    const last = rows.at(-1);
    this.choosing = true;
    this.editor.select(rows[0].line, rows.length > 1 || last.rows > 1 ? last.line + last.rows - 1 : rows[0].line);
    this.choosing = false;
    this.refresh();
  }

  goToLine(line) {
    if (this.place.dataset.shown === "found") this.show("text");
    this.editor.select(line, line, { focus: true });
  }

  // Carry out the action of one button; ignore other buttons until it is done.
  async busy(act) {
    if (this.working) return;
    this.working = true;
    this.refresh();
    try {
      await this.current();
      await act();
    } finally {
      this.working = false;
      if (!this.closed) this.refresh();
    }
  }

  // Wait until the list is up to date: the buttons use its line numbers.
  async current() {
    if (this.listed !== this.editor.doc) await this.list();
  }

  refresh() {
    if (!this.opened) return;
    const changed = this.isChanged;
    text(this.title, `${changed ? "● " : ""}${this.file.file.split("/").at(-1)}`);
    mark(this.title, "title", `${this.file.file}: choose another program`);
    mark(this.title, "data-changed", String(changed));
    this.saveButton.disabled = !changed;
    const steps = this.editor.steps;
    this.undoButton.disabled = !steps.undo;
    this.redoButton.disabled = !steps.redo;
    this.viaShown.hidden = !this.app.teachingVia || !this.mayEdit;
    for (const one of this.acts) one.button.disabled = this.working || !one.may(this.rows.selected);
  }

  // Highlight the line that is being executed, if it is in this program.
  run() {
    const display = this.app.robot.display;
    const names = [this.file?.file, this.file?.file.split("/").at(-1)];
    const line = display && names.includes(display.under_way) ? display.line : 0;
    this.rows.run(line);
    this.editor.run(line);
  }

  // the analyst

  analyse() {
    this.analyst = new Analyst(this.editor, this.file.file);
    this.analyst.addEventListener("on", () => this.findings.said("Checking …"));
    this.analyst.addEventListener("off", ({ detail }) => this.findings.said(detail));
    this.analyst.addEventListener("findings", ({ detail }) => {
      this.findings.set(detail);
      this.rows.findings(this.findings.marks);
      text(this.tabs.lastChild, detail.length ? `Findings ${detail.length}` : "Findings");
      mark(this.place, "data-found", this.findings.worst);
    });
  }

  fix(fix) {
    if (!this.analyst.fix(fix)) this.app.notice("The text has changed since: check the findings again.", true);
  }

  async format() {
    const count = await this.analyst.format().catch((error) => (this.app.notice(error.message, true), null));
    if (count !== null) this.say(count ? "The text was formatted." : "The text was formatted already.");
  }

  // Return true if the page may be left. Before the page Run, the user decides about unsaved changes, because a run
  // uses the file on the disk. Other pages, such as Jog, need no decision: the changes are kept as a draft.
  async mayLeave() {
    if (!this.isChanged || !location.hash.startsWith("#/run")) return true;
    this.keep();
    const answers = [["Save", "save", "main"], ["Leave, keep the draft", "keep"], ["Discard my changes", "discard"], ["Stay", "stay"]];
    const said = await this.sheet.ask(`${this.file.file} isn't saved`, h("p", {}, "Run executes the saved version. If you leave, a draft is kept in this browser."), answers);
    if (said === "discard") this.file.discard();
    this.discarded = said === "discard";
    if (said === "save") {
      if (this.file.other) this.saving.conflict();
      else await this.saving.write();
      return !this.isChanged;
    }
    return said !== "stay";
  }

  close() {
    if (!this.discarded) this.keep();
    this.app.unsaved = this.isChanged && !this.discarded;
    if (this.opened) this.app.left = { file: this.file.file, lines: this.editor.lines, state: this.editor.kept };
    this.closed = true;
    clearTimeout(this.listing);
    clearTimeout(this.keeping);
    clearTimeout(this.saying);
    this.ending.abort();
    this.analyst?.close();
    this.file?.close();
    this.rows.close();
    this.sheet.close();
    this.editor.close();
  }
}

export function programPage(place, app, rest) {
  const name = rest || app.recall("program").file || "";
  const page = new ProgramPage(place, app);
  if (name) page.open(name);
  else page.nothing("No program is open.");
  const leave = () => page.close();
  leave.asks = () => page.mayLeave();
  return leave;
}
