// Display of the differences between two texts: side by side, or in one column on a narrow screen.

import { EditorState, EditorView, MergeView, lineNumbers, unifiedMergeView } from "/bundles/codemirror.js";
import { h } from "/dom.js";
import { THEME } from "/program/editor.js";

const LOOK = EditorView.theme({
  "&": { height: "auto", borderRadius: "0" },
  ".cm-changedLine, &.cm-merge-b .cm-changedLine": { backgroundColor: "var(--code-added)" },
  "&.cm-merge-a .cm-changedLine, .cm-deletedChunk": { backgroundColor: "var(--code-removed)" },
  "&.cm-merge-a .cm-changedText, .cm-deletedChunk .cm-deletedText": { background: "var(--code-removed-text)" },
  "&.cm-merge-b .cm-changedText": { background: "var(--code-added-text)" },
  ".cm-collapsedLines:before, .cm-collapsedLines:after": { content: "''" },
  ".cm-collapsedLines": { background: "var(--key)", color: "var(--soft)", minHeight: "44px", display: "flex", alignItems: "center" },
});

// Return an element that shows the changes from one text to the other, and a function that removes it.
export function compared(before, after, language) {
  const host = h("div", { class: "compared" });
  const root = host.attachShadow({ mode: "open" });
  const look = [lineNumbers(), EditorState.readOnly.of(true), EditorView.editable.of(false), THEME, LOOK, language];
  const collapseUnchanged = { margin: 2, minSize: 4 };
  if (window.innerWidth < 1000) {
    const extensions = [look, unifiedMergeView({ original: before, mergeControls: false, collapseUnchanged, gutter: true })];
    const view = new EditorView({ parent: root, root, state: EditorState.create({ doc: after, extensions }) });
    return { host, close: () => view.destroy() };
  }
  const view = new MergeView({ a: { doc: before, extensions: look }, b: { doc: after, extensions: look }, parent: root, root, collapseUnchanged, gutter: true });
  return { host, close: () => view.destroy() };
}
