// The analyst of a program: a language server behind the WebSocket /api/analyst. Its messages are shown as text, never
// parsed as HTML.

import { address } from "/api.js";
import { h } from "/dom.js";
import { hoverTooltip, setDiagnostics } from "/bundles/codemirror.js";

const PAUSE = 150; // time from the last change of the text until it is sent [ms]
const AGAIN = 3000;
const FINAL = { 4401: "", 4403: "Findings need the role programmer.", 4409: "" };
const SEVERITIES = [null, "error", "warning", "info", "hint"];
const MOST_FIXED = 60;

const place = (doc, at) => {
  const line = doc.lineAt(at);
  return { line: line.number - 1, character: at - line.from };
};
const offset = (doc, { line, character }) => (line >= doc.lines ? doc.length : Math.min(doc.line(line + 1).from + character, doc.line(line + 1).to));
const range = (doc, from, to) => ({ start: place(doc, from), end: place(doc, to) });

export class Analyst extends EventTarget {
  constructor(editor, file) {
    super();
    this.editor = editor;
    this.uri = `yarc:///${file.split("/").map(encodeURIComponent).join("/")}`;
    this.waiting = new Map();
    this.next = 1;
    this.ready = false;
    this.changed = ({ detail }) => this.note(detail);
    editor.addEventListener("changed", this.changed);
    editor.help(hoverTooltip((view, at) => this.hover(at)), (context) => this.complete(context));
    this.open();
  }

  open() {
    this.socket = new WebSocket(address("/api/analyst"));
    const mine = this.socket;
    mine.onmessage = (event) => mine === this.socket && this.hear(JSON.parse(event.data));
    mine.onclose = (event) => {
      if (mine !== this.socket || this.closed) return;
      this.forget();
      if (event.code in FINAL || this.over) this.tell("off", this.over || FINAL[event.code] || event.reason);
      else {
        this.tell("off", "No connection to the analyst: findings aren't current.");
        this.again = setTimeout(() => this.open(), AGAIN);
      }
    };
  }

  tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  forget() {
    this.ready = false;
    for (const { fail } of this.waiting.values()) fail(new Error("the analyst has ended"));
    this.waiting.clear();
  }

  send(method, params = {}) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ method, params }));
  }

  ask(method, params = {}) {
    this.flush();
    if (this.socket.readyState !== WebSocket.OPEN) return Promise.reject(new Error("not connected"));
    const id = this.next++;
    return new Promise((done, fail) => {
      this.waiting.set(id, { done, fail });
      this.socket.send(JSON.stringify({ id, method, params }));
    });
  }

  hear(told) {
    if (told.id !== undefined) {
      const asked = this.waiting.get(told.id);
      this.waiting.delete(told.id);
      if (told.error) asked?.fail(new Error(told.error.message));
      else asked?.done(told.result);
    } else if (told.method === "yarc/begun") this.begin();
    else if (told.method === "yarc/ended") this.over = told.params.text;
    else if (told.method === "yarc/refused") this.tell("off", told.params.error);
    else if (told.method === "textDocument/publishDiagnostics" && told.params.uri === this.uri) this.find(told.params);
  }

  async begin() {
    this.forget();
    await this.ask("initialize").catch(() => null);
    this.send("initialized");
    this.version = 1;
    this.changes = null;
    this.sent = this.editor.doc;
    this.send("textDocument/didOpen", { textDocument: { uri: this.uri, version: 1, text: this.sent.toString() } });
    this.ready = true;
    this.tell("on");
  }

  // texts

  note(update) {
    if (!this.ready) return;
    if (update === null) this.whole = true;
    else this.changes = this.changes ? this.changes.compose(update.changes) : update.changes;
    clearTimeout(this.pause);
    this.pause = setTimeout(() => this.flush(), PAUSE);
    this.tell("waiting");
  }

  // Send the changes of the text. The last change comes first, so that it doesn't shift the positions of the others.
  flush() {
    clearTimeout(this.pause);
    if (!this.ready || (!this.changes && !this.whole)) return;
    const made = [];
    if (this.whole) made.push({ range: range(this.sent, 0, this.sent.length), text: this.editor.text });
    else this.changes.iterChanges((from, to, _from, _to, text) => made.unshift({ range: range(this.sent, from, to), text: text.toString() }));
    this.changes = null;
    this.whole = false;
    this.sent = this.editor.doc;
    this.version += 1;
    this.send("textDocument/didChange", { textDocument: { uri: this.uri, version: this.version }, contentChanges: made });
  }

  // findings

  async find({ version, diagnostics }) {
    if (version !== this.version || this.changes || this.whole) return;
    const { doc } = this.editor;
    this.findings = diagnostics.map((one) => {
      const [message, ...help] = one.message.split("\n");
      const from = offset(doc, one.range.start);
      return { from, to: Math.max(from, offset(doc, one.range.end)), line: one.range.start.line + 1, range: one.range, severity: SEVERITIES[one.severity] ?? "error", code: String(one.code ?? ""), message, help: help.join("\n"), fixes: [] };
    });
    this.editor.view.dispatch(setDiagnostics(this.editor.view.state, this.findings.map(underlined)));
    this.tell("findings", this.findings);
    const some = this.findings.slice(0, MOST_FIXED);
    if (!some.length) return;
    const { findings } = this;
    const lines = some.map((one) => one.line - 1);
    const asked = { start: { line: Math.min(...lines), character: 0 }, end: { line: Math.max(...lines), character: 0 } };
    const actions = await this.ask("textDocument/codeAction", { textDocument: { uri: this.uri }, range: asked }).catch(() => []);
    if (findings !== this.findings || !actions.length) return;
    for (const action of actions) {
      const about = action.about[0];
      const one = findings.find((found) => found.code === about?.code && JSON.stringify(found.range) === JSON.stringify(about.range));
      one?.fixes.push({ title: action.title.replace(/ \([A-Z][0-9]+\)$/, ""), doc, edits: action.edit.changes[this.uri] ?? [] });
    }
    this.tell("findings", findings);
  }

  // Apply edits, if the text is still the one for which they were made.
  fix({ doc, edits }) {
    if (doc !== this.editor.doc) return false;
    this.editor.step(edits.map((one) => ({ from: offset(doc, one.range.start), to: offset(doc, one.range.end), insert: one.newText.replace(/\r\n?/g, "\n") })));
    return true;
  }

  async format() {
    const { doc } = this.editor;
    const edits = await this.ask("textDocument/formatting", { textDocument: { uri: this.uri } });
    return this.fix({ doc, edits: edits ?? [] }) ? (edits ?? []).length : null;
  }

  // hover and completion

  at(pos) {
    return { textDocument: { uri: this.uri }, position: place(this.editor.doc, pos) };
  }

  async hover(pos) {
    const { doc } = this.editor;
    const found = await this.ask("textDocument/hover", this.at(pos)).catch(() => null);
    if (!found || doc !== this.editor.doc) return null;
    return {
      pos: found.range ? offset(doc, found.range.start) : pos,
      end: found.range ? offset(doc, found.range.end) : pos,
      above: true,
      create: () => ({ dom: h("div", { class: "cm-said" }, found.contents.value) }),
    };
  }

  async complete(context) {
    if (!context.explicit && !context.matchBefore(/[A-Za-z0-9_.{[($,]$/)) return null;
    const { doc } = context.state;
    const found = await this.ask("textDocument/completion", this.at(context.pos)).catch(() => null);
    if (!found?.items.length || context.aborted) return null;
    const starts = found.items.map((one) => offset(doc, one.textEdit.range.start));
    const from = Math.min(...starts);
    const options = found.items.map((one) => ({
      label: one.label,
      detail: one.detail ?? "",
      sortText: one.sortText,
      apply: one.textEdit.newText,
    }));
    return { from, options: options.filter((_, index) => starts[index] === from) };
  }

  close() {
    this.closed = true;
    clearTimeout(this.again);
    clearTimeout(this.pause);
    this.editor.removeEventListener("changed", this.changed);
    this.socket.close();
  }
}

function underlined({ from, to, severity, code, message, help }) {
  const renderMessage = () => h("div", {}, h("strong", {}, `${code} `), message, help ? h("div", {}, help) : null);
  return { from, to, severity, message, source: code, renderMessage };
}
