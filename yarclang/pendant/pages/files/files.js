// The page Files: the files of the project, their changes since the last commit, uploads and downloads.

import { get, post } from "/api.js";
import { button, h, put, text } from "/dom.js";
import { askName } from "/files/asking.js";
import { address, folderOf, free, nameOf, short, sized, when, within } from "/files/names.js";
import { showDeleted, showDifference, showText } from "/files/showing.js";
import { Uploads } from "/files/uploads.js";
import { pinned, serviced } from "/service.js";

const MARKS = { new: "new", changed: "changed", deleted: "deleted" };
const MOST_SHOWN = 500;
const ORDERS = {
  name: (a, b) => nameOf(a.file).localeCompare(nameOf(b.file), undefined, { numeric: true }),
  newest: (a, b) => b.changed.localeCompare(a.changed),
  largest: (a, b) => b.size - a.size,
};

class Files {
  constructor(place, app) {
    this.app = app;
    this.files = [];
    this.changes = new Map();
    this.folder = app.recall("files").folder ?? "";
    this.chosen = "";
    this.left = false;
    this.uploads = new Uploads(app, (paths) => this.changed(paths.length > 1 ? `${paths.length} files are uploaded.` : `${short(paths[0])} is uploaded.`));
    this.build(place);
    this.look();
  }

  build(place) {
    this.search = h("input", { type: "search", placeholder: "Search files", "aria-label": "Search files", oninput: () => this.draw() });
    this.order = h("select", { "aria-label": "Order", onchange: () => this.draw() }, Object.keys(ORDERS).map((one) => h("option", { value: one }, one)));
    this.way = h("nav", { class: "way", "aria-label": "Folder" });
    this.list = h("ul", { class: "files" });
    this.commit = h("p", { class: "said" });
    const input = h("input", { type: "file", multiple: true, hidden: true, "aria-label": "Files to upload", onchange: () => { this.uploads.add(input.files, this.folder); input.value = ""; } });
    const may = this.app.may("programmer");
    const actions = h("div", { class: "actions" },
      may && button("Upload", () => input.click(), { class: "main" }), may && input,
      may && button("New folder", () => this.newFolder()),
      button("Deleted", () => showDeleted(this.app, (number) => this.restore(number))),
      button("Refresh", () => this.look()));
    this.place = h("section", { class: "list filing" }, h("div", { class: "finding" }, this.search, this.order), this.way, this.list, this.uploads.place, this.commit);
    if (may) this.takeDrops();
    put(place, h("h1", { class: "hidden" }, "Files"), this.place, actions);
  }

  takeDrops() {
    const over = (shown) => this.place.classList.toggle("over", shown);
    this.place.addEventListener("dragover", (event) => { event.preventDefault(); over(true); });
    this.place.addEventListener("dragleave", () => over(false));
    this.place.addEventListener("drop", (event) => {
      event.preventDefault();
      over(false);
      this.uploads.add(event.dataTransfer.files, this.folder);
    });
  }

  async look() {
    const told = await this.app.tried(() => get("/api/files"));
    if (this.left || !told) return;
    this.files = told.files;
    if (told.cut) this.app.notice("The project has more files than can be shown.", true);
    this.draw();
    this.ask();
  }

  async ask() {
    const told = await this.app.tried(() => get("/api/git"));
    if (this.left || !told) return;
    this.changes = new Map(told.changes.map((one) => [one.file, one]));
    const { commit } = told;
    if (!told.there) text(this.commit, `The changes are unknown: ${told.what}.`);
    else if (!commit) text(this.commit, "There is no commit yet.");
    else text(this.commit, `${told.changes.length || "Nothing"} changed since “${commit.subject}” by ${commit.who}, ${when(commit.when)}.`);
    this.draw();
  }

  // Return the files and folders to show: those in the open folder, or all that match the search. Deleted files are
  // included until the next commit.
  shown() {
    const gone = [...this.changes.values()].filter((one) => one.kind === "deleted").map((one) => ({ file: one.file, size: 0, changed: "", kind: "gone" }));
    const wanted = this.search.value.trim().toLowerCase();
    const all = [...this.files, ...gone].filter((one) => (wanted ? one.file.toLowerCase().includes(wanted) : folderOf(one.file) === this.folder));
    const first = (one) => (one.kind === "folder" ? 0 : 1);
    return all.sort((a, b) => first(a) - first(b) || ORDERS[this.order.value](a, b));
  }

  draw() {
    const folders = new Set(this.files.filter((one) => one.kind === "folder").map((one) => one.file));
    if (this.folder && this.files.length && !folders.has(this.folder)) this.folder = "";
    this.way.hidden = !this.folder;
    const steps = this.folder ? this.folder.split("/") : [];
    put(this.way, button("Project", () => this.enter(""), { class: "quiet" }),
      steps.map((name, index) => button(`› ${name}`, () => this.enter(steps.slice(0, index + 1).join("/")), { class: "quiet" })));
    const shown = this.shown();
    put(this.list, shown.slice(0, MOST_SHOWN).map((one) => this.row(one)));
    if (shown.length > MOST_SHOWN) this.list.append(h("li", { class: "empty" }, `And ${shown.length - MOST_SHOWN} more: search for them.`));
    if (!shown.length) put(this.list, h("li", { class: "empty" }, this.search.value ? "No file has this name." : "This folder is empty."));
  }

  row(one) {
    const change = this.changes.get(one.file) ?? (one.kind === "folder" && this.hasChanges(one.file) ? { kind: "changed" } : null);
    const label = this.search.value ? one.file : nameOf(one.file);
    const open = h("button", { type: "button", class: "open", "aria-expanded": String(one.file === this.chosen), onclick: () => this.choose(one) },
      h("span", { class: "filename" }, one.kind === "folder" ? `${label}/` : label),
      change && h("span", { class: `mark ${change.kind}` }, MARKS[change.kind]),
      h("span", { class: "soft" }, one.kind === "folder" || one.kind === "gone" ? "" : `${sized(one.size)}  ${when(one.changed)}`));
    return h("li", { "data-file": one.file }, open, one.file === this.chosen && this.tools(one, this.changes.get(one.file)));
  }

  hasChanges(folder) {
    return [...this.changes.keys()].some((file) => file.startsWith(`${folder}/`));
  }

  choose(one) {
    if (one.kind === "folder" && this.chosen === one.file) this.enter(one.file);
    else {
      this.chosen = this.chosen === one.file ? "" : one.file;
      this.draw();
      const open = this.list.querySelector(".open[aria-expanded=true]");
      open?.focus();
      open?.parentElement.scrollIntoView({ block: "nearest" });
    }
  }

  tools(one, change) {
    const may = this.app.may("programmer") && one.kind !== "gone";
    const isFile = one.kind !== "folder" && one.kind !== "gone";
    return h("div", { class: "tools" },
      change && h("p", { class: "said" }, by(change)),
      one.kind === "folder" && button("Open", () => this.enter(one.file), { class: "main" }),
      isFile && button("Open", () => this.open(one), { class: "main" }),
      change && button("Difference", () => showDifference(this.app, change, by(change))),
      isFile && h("a", { class: "press", href: address("download", one.file), download: "" }, "Download"),
      may && isFile && button("Copy", () => this.copy(one.file)),
      may && button("Rename", () => this.rename(one.file)),
      may && button("Delete", () => this.remove(one.file)));
  }

  enter(folder) {
    this.folder = folder;
    this.chosen = "";
    this.search.value = "";
    this.app.remember("files", { folder });
    this.draw();
    this.list.scrollTop = 0;
  }

  open(one) {
    if (one.kind === "program") location.hash = `#/program/${encodeURIComponent(one.file)}`;
    else showText(this.app, one.file);
  }

  async changed(said, ...actions) {
    this.told?.remove();
    const notice = this.app.notice(said, false, ...actions);
    this.told = notice;
    for (const action of actions) action.addEventListener("click", () => notice.remove());
    if (actions.length) setTimeout(() => notice.remove(), 20000);
    await this.look();
  }

  copy(file) {
    const taken = new Set(this.files.map((one) => one.file));
    askName("Copy to", free(file, taken), "Copy", async (to) => {
      await pinned(this.app, () => post("/api/files/copy", { file, to }));
      this.changed(`${short(to)} is a copy of ${short(file)}.`);
    });
  }

  rename(file) {
    askName("New name", file, "Rename", async (to) => {
      await pinned(this.app, () => post("/api/files/rename", { file, to }));
      this.chosen = to;
      this.changed(`${short(file)} was renamed to ${short(to)}.`);
    });
  }

  newFolder() {
    askName("New folder", within(this.folder, ""), "Make", async (file) => {
      await pinned(this.app, () => post("/api/files/folder", { file }));
      this.changed(`The folder ${file} was created.`);
    });
  }

  async remove(file) {
    const told = await serviced(this.app, () => post("/api/files/delete", { file }));
    if (told) this.changed(`${short(file)} was deleted.`, button("Undo", () => this.restore(told.number)));
  }

  async restore(number) {
    const told = await serviced(this.app, () => post("/api/files/restore", { number }));
    if (told) this.changed(`${short(told.file)} was restored.`);
  }

  close() {
    this.left = true;
    this.uploads.close();
  }
}

// Return a sentence about the users who have changed a file since the last commit.
function by(change) {
  const people = change.by?.length ? `Changed by ${change.by.join(", ")} at the pendant` : "";
  if (!change.outside) return people && `${people}.`;
  return people ? `${people}, and outside of the pendant since.` : "Changed outside of the pendant.";
}

export function filesPage(place, app) {
  const files = new Files(place, app);
  app.whenBack(() => files.look());
  return () => files.close();
}
