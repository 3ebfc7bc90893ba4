// Dialogs that show a text file of the project, or its changes since the last commit.

import { get } from "/api.js";
import { button, h, put } from "/dom.js";
import { opened } from "/files/asking.js";
import { address } from "/files/names.js";

// Create a shadow root for CodeMirror. There CodeMirror adopts style sheets, which the content security policy allows;
// elsewhere it would insert style elements.
function shadow() {
  const host = h("div", { class: "editor" });
  return [host, host.attachShadow({ mode: "open" })];
}

export async function showText(app, file) {
  const told = await app.tried(() => get(address("files", file)));
  if (!told) return;
  const { EditorState, EditorView, lineNumbers } = await import("/bundles/codemirror.js");
  const [host, root] = shadow();
  const view = new EditorView({ state: EditorState.create({ doc: told.text, extensions: common(EditorView, EditorState, lineNumbers) }), parent: root, root });
  frame(file, "", host, () => view.destroy());
}

export async function showDifference(app, change, by) {
  const told = await app.tried(() => get(address("git/difference", change.file)));
  if (!told) return;
  const { EditorState, EditorView, MergeView, lineNumbers } = await import("/bundles/codemirror.js");
  const [host, root] = shadow();
  const side = (doc) => ({ doc, extensions: common(EditorView, EditorState, lineNumbers) });
  const view = new MergeView({ a: side(told.base), b: side(told.text), parent: root, root, collapseUnchanged: { margin: 3, minSize: 6 }, gutter: true, diffConfig: { scanLimit: 2000, timeout: 500 } });
  frame(change.file, `Left: the last commit. Right: now. ${by}`, host, () => view.destroy());
}

function common(EditorView, EditorState, lineNumbers) {
  return [
    lineNumbers(),
    EditorState.readOnly.of(true),
    EditorView.editable.of(false),
    EditorView.lineWrapping,
    EditorView.theme({
      "&": { color: "var(--ink)", backgroundColor: "var(--card)", fontSize: "0.9rem" },
      ".cm-gutters": { color: "var(--soft)", backgroundColor: "var(--ground)", borderColor: "var(--line)" },
      ".cm-collapsedLines": { color: "var(--ink)", background: "var(--key)", minHeight: "44px", lineHeight: "44px" },
    }),
  ];
}

function frame(file, said, host, close) {
  const dialog = opened(h("div", { class: "reading" }, h("h2", { class: "filename" }, file), said && h("p", { class: "said" }, said), host, h("div", { class: "actions" },
    h("a", { class: "press", href: address("download", file), download: "" }, "Download"),
    button("Close", () => dialog.close(), { class: "main" }))), "shows", close);
}

export async function showDeleted(app, restore) {
  const told = await app.tried(() => get("/api/trash"));
  if (!told) return;
  const list = h("ul", { class: "files" });
  put(list, told.deleted.map((one) => h("li", {}, h("span", { class: "filename" }, one.file), h("span", { class: "soft" }, `${one.user}, ${new Date(one.deleted).toLocaleString()}`),
    app.may("programmer") && button("Bring back", () => { dialog.close(); restore(one.number); }))));
  if (!told.deleted.length) put(list, h("li", { class: "empty" }, "Nothing is kept."));
  const dialog = opened(h("div", { class: "reading" }, h("h2", {}, "Deleted"), h("p", { class: "said" }, "Kept for 30 days."), list, h("div", { class: "actions" }, button("Close", () => dialog.close(), { class: "main" }))), "shows");
}
