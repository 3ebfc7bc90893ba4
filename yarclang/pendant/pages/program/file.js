// A program file of the project: opening, saving, detection of changes by others, and a draft of unsaved changes, which
// survives a reload and a lost connection.

import { call, get } from "/api.js";

export const addressAt = (file) => `/api/files/${file.split("/").map(encodeURIComponent).join("/")}`;
const EACH = 5000; // time between two checks of the file on the disk [ms]

export class ProgramFile extends EventTarget {
  constructor(app, file) {
    super();
    this.app = app;
    this.file = file;
    this.key = `yarc.${app.me.user}.draft.${file}`;
    this.looking = setInterval(() => this.look(), EACH);
    this.focused = () => !document.hidden && this.look();
    window.addEventListener("focus", this.focused);
    document.addEventListener("visibilitychange", this.focused);
  }

  // Read the file. Return its text with "\n" as line ends.
  async open() {
    return this.take(await get(addressAt(this.file)));
  }

  take(told) {
    this.sha = told.sha256;
    this.mark = told.text.startsWith("\ufeff") ? "\ufeff" : "";
    const text = told.text.slice(this.mark.length);
    this.ends = /\r\n/.test(text) && !/(^|[^\r])\n/.test(text) ? "\r\n" : "\n";
    this.base = text.replace(/\r\n?/g, "\n");
    this.other = null;
    return this.base;
  }

  // Check whether somebody else has changed the file.
  async look() {
    if (this.sha === undefined || this.busy || document.hidden) return;
    let told;
    try {
      told = await get(addressAt(this.file));
    } catch (refused) {
      if (refused.status === 0 || refused.status === 401) return;
      told = { gone: true, sha256: "", text: "" };
    }
    if (this.busy || this.closed) return;
    if (told.sha256 === this.sha) {
      if (this.other) this.tell("same", (this.other = null));
      return;
    }
    if (this.other?.sha256 === told.sha256) return;
    this.other = told;
    this.tell("other", told);
  }

  tell(name, detail = null) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  // Write a text. `over` is the hash of the version that it replaces, by default the version that was opened.
  async save(text, over = this.sha) {
    this.busy = true;
    try {
      const written = await call("PUT", addressAt(this.file), { text: this.mark + text.replaceAll("\n", this.ends), known: over || null });
      this.sha = written.sha256;
      this.base = text;
      this.other = null;
      this.keep(text);
    } finally {
      this.busy = false;
    }
  }

  // the draft

  keep(text) {
    try {
      if (text === this.base) localStorage.removeItem(this.key);
      else localStorage.setItem(this.key, JSON.stringify({ sha: this.sha, text }));
      return true;
    } catch {
      return false;
    }
  }

  get draft() {
    try {
      const kept = JSON.parse(localStorage.getItem(this.key));
      return typeof kept?.text === "string" && kept.text !== this.base ? kept : null;
    } catch {
      return null;
    }
  }

  discard() {
    localStorage.removeItem(this.key);
  }

  close() {
    this.closed = true;
    clearInterval(this.looking);
    window.removeEventListener("focus", this.focused);
    document.removeEventListener("visibilitychange", this.focused);
  }
}
