// Uploads to the project, one after the other. Each shows its progress and can be cancelled.

import { button, h, put } from "/dom.js";
import { address, sized, within } from "/files/names.js";
import { askPin, serviced } from "/service.js";

const LARGEST = 100_000_000;

export class Uploads {
  // `done` is called with the uploaded files when no upload is left.
  constructor(app, done) {
    this.app = app;
    this.done = done;
    this.waiting = [];
    this.current = null;
    this.arrived = [];
    this.place = h("ul", { class: "uploads", "aria-label": "Uploads", hidden: true });
  }

  add(files, folder) {
    for (const file of files) {
      if (file.size > LARGEST) this.app.notice(`${file.name} has ${sized(file.size)}, but at most ${sized(LARGEST)} can be uploaded.`, true);
      else this.waiting.push({ file, path: within(folder, file.name) });
    }
    this.next();
  }

  next() {
    if (!this.current) {
      this.current = this.waiting.shift() ?? null;
      if (this.current) this.send(this.current);
      else if (this.arrived.length) this.done(this.arrived.splice(0));
    }
    this.draw();
  }

  send(one) {
    const request = new XMLHttpRequest();
    one.request = request;
    one.bar = h("progress", { max: 1, value: 0, "aria-label": `Upload of ${one.path}` });
    request.open("POST", address("upload", one.path));
    request.setRequestHeader("content-type", "application/octet-stream");
    request.upload.onprogress = (event) => event.lengthComputable && (one.bar.value = event.loaded / event.total);
    request.onload = () => this.ended(one, request);
    request.onerror = () => this.ended(one, null);
    request.onabort = () => this.ended(one, undefined);
    request.send(one.file);
  }

  ended(one, request) {
    if (request === null) this.app.notice(`${one.path}: the upload was interrupted.`, true);
    else if (request && request.status !== 200) this.refused(one, request);
    else if (request) this.arrived.push(one.path);
    this.current = null;
    this.next();
  }

  refused(one, request) {
    let told = { error: `the server answers ${request.status}` };
    try {
      told = JSON.parse(request.responseText);
    } catch {
      // the response isn't JSON of this API
    }
    if (request.status === 401) document.dispatchEvent(new CustomEvent("loggedout", { detail: told }));
    if (told.code === "pin") {
      this.pinned(one);
      return;
    }
    const replace = told.code === "changed" && told.sha256 && button("Replace it", () => this.replace(one, told.sha256));
    const notice = this.app.notice(told.help ? `${told.error}: ${told.help}` : told.error, true, ...(replace ? [replace] : []));
    if (replace) replace.addEventListener("click", () => notice.remove());
  }

  // Ask for the PIN, then upload a file again that describes the robot or its cell.
  async pinned(one) {
    if (!(await askPin(this.app))) return;
    this.waiting.unshift({ file: one.file, path: one.path });
    this.next();
  }

  // Upload a file again, over an existing file. The server checks that this file is still the version `known`.
  replace(one, known) {
    serviced(this.app, async () => {
      const answer = await fetch(`${address("upload", one.path)}?known=${known}`, { method: "POST", body: one.file, credentials: "same-origin" })
        .catch(() => { throw new Error(`${one.path}: the upload was interrupted.`); });
      if (answer.ok) return this.done([one.path]);
      const told = await answer.json();
      throw Object.assign(new Error(told.error), { code: told.code, status: answer.status });
    });
  }

  cancel(one) {
    if (one === this.current) one.request.abort();
    this.waiting = this.waiting.filter((other) => other !== one);
    this.draw();
  }

  draw() {
    const all = [this.current, ...this.waiting].filter(Boolean);
    this.place.hidden = !all.length;
    put(this.place, all.map((one) => h("li", {}, h("span", { class: "filename" }, one.path), one.bar ?? h("span", {}, "waits"), button("Cancel", () => this.cancel(one)))));
  }

  close() {
    this.waiting = [];
    this.current?.request.abort();
  }
}
