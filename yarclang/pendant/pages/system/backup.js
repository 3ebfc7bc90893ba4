// The page Backup: download of the project as a zip; upload of a backup, with its check, its comparison with the
// project, its restore, and undoing the restore.

import { get, post } from "/api.js";
import { button, h, put } from "/dom.js";
import { sized, when } from "/files/names.js";
import { planned } from "/system/plan.js";
import { count, styled } from "/system/look.js";

export function backupPage(place, app) {
  styled("backup");
  const page = new BackupPage(place, app);
  page.look(true);
  app.whenBack(() => page.look(true));
  return () => page.close();
}

class BackupPage {
  constructor(place, app) {
    this.app = app;
    this.saving = h("div", {});
    this.waiting = h("div", { "aria-live": "polite" });
    this.undoing = h("div", {});
    this.logs = h("input", { type: "checkbox", onchange: () => this.link() });
    this.save = h("a", { class: "press main", href: "/api/backup", download: "" }, "Back up");
    this.file = h("input", { type: "file", accept: ".zip,application/zip", hidden: true, "aria-label": "Backup to restore", onchange: () => this.chosen() });
    this.choose = button("Choose a zip", () => this.file.click());
    put(place, h("h1", { class: "hidden" }, "Backup"),
      h("div", { class: "backup-page" },
        h("section", {}, h("h2", {}, "Back up"), this.saving),
        h("section", {}, h("h2", {}, "Restore"),
          h("p", { class: "soft" }, "A zip is checked first; nothing changes before you confirm."),
          this.file, h("div", { class: "actions" }, this.choose), this.waiting, this.undoing)));
  }

  link() {
    this.save.setAttribute("href", this.logs.checked ? "/api/backup?logs=1" : "/api/backup");
  }

  // Show what a backup would contain, and which restores can be undone.
  async look(first = false) {
    put(this.saving, h("p", {}, "Reading the project."));
    const told = await this.app.tried(() => get("/api/backup/about"));
    if (!told || this.left) return;
    if (first && told.waits) this.ask();
    const logs = told.logs ? h("label", { class: "switch" }, this.logs, `with ${count(told.logs, "run log")} (${sized(told.logs_size)})`) : null;
    put(this.saving,
      told.trouble ? h("p", { class: "bad" }, told.trouble) : [h("p", {}, `${count(told.files, "file")} of ${told.robot}'s project, ${sized(told.size)}.`), logs, h("div", { class: "actions" }, this.save)],
      told.notes.map((one) => h("p", { class: "soft" }, `${one}.`)),
      told.left_out.length ? h("details", {}, h("summary", {}, `${count(told.left_out.length, "file")} can't be backed up`),
        h("ul", {}, told.left_out.map(({ file, why }) => h("li", {}, h("span", { class: "filename" }, file), `: ${why}`)))) : null);
    put(this.undoing, told.undo.length ? h("h2", {}, "Undo a restore") : null,
      told.undo.slice(0, 5).map((one) => h("div", { class: "undo" }, h("span", {}, `${when(one.made)}, ${one.user}, ${sized(one.size)}`),
        button("Undo", () => this.undo(one.number)))));
  }

  // Show the changes that this session's uploaded backup would make now.
  async ask() {
    try {
      this.show(await get("/api/backup/plan"));
    } catch {
      // the upload no longer exists
    }
  }

  chosen() {
    const [file] = this.file.files;
    this.file.value = "";
    if (!file) return;
    const request = new XMLHttpRequest();
    const bar = h("progress", { max: 1, value: 0, "aria-label": `Upload of ${file.name}` });
    const told = h("span", {}, "Uploading");
    put(this.waiting, h("div", { class: "sending" }, told, bar, button("Cancel", () => request.abort())));
    this.choose.disabled = true;
    request.open("POST", "/api/backup/upload");
    request.setRequestHeader("content-type", "application/zip");
    request.upload.onprogress = (event) => event.lengthComputable && (bar.value = event.loaded / event.total);
    request.upload.onload = () => told.replaceChildren("Looking through it");
    request.onload = () => this.uploaded(request);
    request.onerror = () => this.refused("The upload was broken off.");
    request.onabort = () => this.refused("");
    this.request = request;
    request.send(file);
  }

  uploaded(request) {
    let told = { error: `the server answers ${request.status}` };
    try {
      told = JSON.parse(request.responseText);
    } catch {
      // the response isn't JSON of this API
    }
    if (request.status === 401) document.dispatchEvent(new CustomEvent("loggedout", { detail: told }));
    if (request.status === 200) this.show(told);
    else this.refused(told.help ? `${told.error}: ${told.help}.` : told.error);
  }

  refused(what) {
    this.choose.disabled = false;
    put(this.waiting, what ? h("p", { class: "bad refused", role: "alert" }, what[0].toUpperCase() + what.slice(1)) : null);
  }

  async undo(number) {
    const plan = await this.app.tried(() => post("/api/backup/undo", { number }));
    if (plan) this.show(plan);
  }

  show(plan) {
    if (this.left) return;
    this.choose.disabled = false;
    put(this.waiting, planned(this.app, plan, (done) => this.ended(done)));
    this.waiting.scrollIntoView({ block: "nearest" });
  }

  // `done` is the result of the restore; "again": the project has changed, so the comparison is repeated; null: the
  // restore was cancelled.
  ended(done) {
    if (this.left) return;
    put(this.waiting);
    if (done === "again") this.ask();
    else if (done) {
      put(this.waiting, h("p", { class: "restored", role: "status" }, said(done)),
        done.restart.length ? h("p", { class: "warn" }, `${done.restart.join(", ")}: this takes effect after a restart. `, h("a", { href: "#/system/controller", class: "press" }, "Controller")) : null);
    }
    this.look();
  }

  close() {
    this.left = true;
    this.request?.abort();
  }
}

function said(done) {
  if (!done.undo) return "No changes were needed.";
  return `Restored: ${count(done.written, "file")}; deleted: ${done.removed}. The replaced files are kept for 30 days, here and on the page Files.`;
}
