// The page Workspace: zones, obstacles and joint limits as numbers and in the scene, drafts of changes, distances, and
// the programs that a draft breaks.

import { get, post } from "/api.js";
import { button, h, mark, put, text } from "/dom.js";
import { Sheet } from "/program/sheet.js";
import { picture } from "/scene/page.js";
import { pinned } from "/service.js";
import { Draft, isChanged } from "/setup/workspace/draft.js";
import { EntryForm, acts } from "/setup/workspace/form.js";
import { Ghosts } from "/setup/workspace/ghosts.js";
import { Limits } from "/setup/workspace/limits.js";
import { Nearest } from "/setup/workspace/near.js";
import { Saving } from "/setup/workspace/saving.js";

const PARTS = [["bodies", "Bodies"], ["limits", "Limits"], ["near", "Distances"]];
const MOST_SHOWN = 300;

class Workspace {
  constructor(place, app) {
    this.app = app;
    this.draft = new Draft();
    this.chosen = null;
    style();
    this.may = app.may("programmer");
    this.form = new EntryForm(this.draft, this.may);
    this.limits = new Limits(this.draft, this.may);
    this.near = new Nearest(this.draft);
    this.build(place);
    this.saving = new Saving(this);
    this.draft.addEventListener("changed", () => this.refresh());
    this.load();
  }

  build(place) {
    this.picture = picture(this.app);
    this.list = h("ul", { class: "bodies" });
    this.more = h("p", { class: "soft" });
    this.why = h("div", { class: "whys" });
    this.modes = h("div", { class: "modes", role: "group", "aria-label": "Handles", hidden: true },
      [["translate", "Move"], ["rotate", "Turn"]].map(([mode, label]) => button(label, () => this.handle(mode), { "data-mode": mode })));
    this.tools = h("div", { class: "chosen-tools" });
    this.adding = h("div", { class: "actions adding" }, button("Add obstacle", () => this.add("obstacles")), button("Add zone", () => this.add("zones")));
    this.bar = h("div", { class: "actions draft-bar" });
    this.said = h("span", { class: "said" });
    this.undo = button("Undo", () => this.draft.undo());
    this.drop = button("Discard", () => this.load());
    this.save = button("Save", () => this.saving.open(), { class: "main" });
    put(this.bar, this.said, this.undo, this.drop, this.save);
    this.tabs = h("div", { class: "parts-tabs", role: "tablist" }, PARTS.map(([name, label]) => button(label, () => this.show(name), { role: "tab", "data-tab": name })));
    const bodies = h("section", { "data-part": "bodies" }, this.why, this.list, this.more, this.adding, this.form.place, this.tools);
    this.sides = h("div", { class: "sides" }, bodies, part(this.limits.place, "limits"), part(this.near.place, "near"));
    const side = h("div", { class: "side" }, this.tabs, this.sides, this.bar);
    this.picture.element.append(this.modes);
    this.place = h("div", { class: "workspace" }, this.picture.element, side);
    this.place.shown = this;
    this.sheet = new Sheet(this.place);
    put(place, h("h1", { class: "hidden" }, "Workspace"), this.place);
    this.end = this.picture.open();
    this.show("bodies");
    this.picture.scene.element.addEventListener("drawn", () => this.drawn());
  }

  // The scene has been drawn: bodies of the draft can be added to it.
  drawn() {
    const { scene } = this.picture;
    if (scene.failed || this.closed) return;
    if (!this.ghosts) {
      let marked = false;
      this.ghosts = new Ghosts(scene, this.draft, {
        began: () => (marked = false),
        dragged: (key, values) => {
          this.draft.set(key, values, marked);
          marked = true;
        },
      });
      this.ghosts.may = this.may && !this.draft.told?.why;
      this.near.scene = scene;
      this.picture.element.querySelector("[data-view=fit]")?.click();
    }
    this.ghosts.choose(this.chosen);
  }

  show(name) {
    mark(this.place, "data-shown", name);
    this.sides.scrollTop = 0;
    for (const tab of this.tabs.children) mark(tab, "aria-selected", String(tab.dataset.tab === name));
  }

  async load() {
    const told = await this.app.tried(() => get("/api/workspace"));
    if (!told || this.closed) return;
    this.sheet.close();
    this.chosen = null;
    if (this.ghosts) this.ghosts.may = this.may && !told.why;
    this.form.may = this.may && !told.why;
    this.form.form = undefined;
    this.draft.open(told);
  }

  choose(key) {
    this.chosen = this.chosen === key ? null : key;
    this.ghosts?.choose(this.chosen);
    this.refresh();
    if (this.chosen) this.form.place.scrollIntoView({ block: matchMedia("(max-height: 600px)").matches ? "start" : "nearest" });
  }

  handle(mode) {
    this.ghosts?.choose(this.chosen, mode);
    this.refresh();
  }

  add(table) {
    const { told } = this.draft;
    const unit = told.metre ?? 0.001;
    const size = [0.2, 0.2, 0.2].map((one) => Number((one / unit).toPrecision(6)));
    const xyz = [0.8, 0, 0.1].map((one) => Number((one / unit).toPrecision(6)));
    const values = { shape: "box", frame: "B", xyz, size };
    const key = this.draft.add(table, table === "zones" ? { name: "ZONE", rule: "forbidden", ...values } : { name: "OBSTACLE", ...values });
    this.chosen = null;
    this.choose(key);
  }

  async make() {
    const made = await this.app.tried(() => pinned(this.app, () => post("/api/workspace/cell", { file: "cell.toml" })));
    if (made) {
      this.app.notice(made.told);
      this.load();
    }
  }

  // Show the present draft.
  refresh() {
    const { told, size } = this.draft;
    if (!told || this.closed) return;
    if (this.chosen && !this.draft.item(this.chosen)) this.chosen = null;
    const can = this.may && !told.why;
    const errors = told.findings.filter((one) => one.severity === "error");
    put(this.why,
      told.why && h("p", { class: "why" }, told.why),
      !told.cell && this.app.may("service") && button("Make cell.toml", () => this.make(), { class: "main" }),
      errors.slice(0, 3).map((one) => h("p", { class: "why held-back" }, `Line ${one.line ?? "?"}: ${one.message}`)));
    this.drawList();
    text(this.more, this.draft.items.length > MOST_SHOWN ? `And ${this.draft.items.length - MOST_SHOWN} more: change them in the file.` : "");
    this.adding.hidden = !can;
    this.form.show(this.chosen);
    put(this.tools, can && this.chosen && acts(this.draft, this.chosen, (key) => ((this.chosen = null), key ? this.choose(key) : this.refresh())));
    this.limits.show();
    this.ghosts?.choose(this.chosen);
    this.modes.hidden = !(can && this.chosen && this.ghosts);
    for (const one of this.modes.children) mark(one, "aria-pressed", String(one.dataset.mode === this.ghosts?.mode));
    text(this.said, size === 0 ? "No changes" : size === 1 ? "1 change" : `${size} changes`);
    this.undo.disabled = !this.draft.past.length;
    this.drop.disabled = this.save.disabled = size === 0;
    this.bar.hidden = !this.may;
  }

  // Reuse rows that haven't changed: a drag changes one row many times.
  drawList() {
    const before = this.rows ?? new Map();
    this.rows = new Map(this.draft.items.slice(0, MOST_SHOWN).map((one) => {
      const said = JSON.stringify([one.values, one.gone, isChanged(one), one.key === this.chosen]);
      const known = before.get(one.key);
      return [one.key, known?.said === said ? known : { said, row: this.row(one) }];
    }));
    const rows = [...this.rows.values()].map(({ row }) => row);
    if (rows.length !== this.list.children.length || rows.some((row, at) => row !== this.list.children[at])) put(this.list, rows);
  }

  row(one) {
    const { values, gone, key, table } = one;
    const kind = table === "zones" ? `${values.rule ?? "?"} zone` : "obstacle";
    const state = gone ? "removed" : one.at === null ? "new" : isChanged(one) ? "changed" : "";
    const place = values.xyz ? `${values.frame} ${values.xyz.join(" ")}` : values.frame ?? "";
    const margin = values.margin ? `, margin ${values.margin}` : "";
    return h("li", {}, h("button", { type: "button", "aria-pressed": String(key === this.chosen), disabled: gone, "data-name": values.name, onclick: () => this.choose(key) },
      h("span", { class: gone ? "name gone" : "name" }, values.name ?? "?"), state && h("span", { class: `mark ${state}` }, state),
      h("small", {}, `${kind}, ${values.shape ?? "?"}, ${place}${margin}`)));
  }

  close() {
    this.closed = true;
    this.near.close();
    this.ghosts?.close();
    this.sheet.close();
    this.end();
  }
}

function part(place, name) {
  place.dataset.part = name;
  return place;
}

function style() {
  for (const href of ["/setup/workspace/workspace.css"])
    if (!document.querySelector(`link[href='${href}']`)) document.head.append(h("link", { rel: "stylesheet", href }));
}

export function workspacePage(place, app) {
  const page = new Workspace(place, app);
  app.whenBack(() => page.draft.told || page.load());
  const leave = () => page.close();
  leave.asks = () => page.draft.size === 0 || page.sheet.ask("Leave without saving the changes?", "The changes will be lost.", [["Leave", true], ["Stay", false, "main"]]);
  return leave;
}
