// The text editor: CodeMirror in a shadow root. There it uses constructed style sheets, which the content security
// policy allows.

import {
  Compartment, Decoration, EditorState, EditorView, StateEffect, StateField, Transaction, autocompletion, bracketMatching, completionKeymap, defaultKeymap, drawSelection,
  highlightActiveLine, highlightActiveLineGutter, highlightSelectionMatches, history, historyField, historyKeymap, indentWithTab, isolateHistory, keymap, lineNumbers, lintGutter, lintKeymap,
  redo, redoDepth, search, searchKeymap, tooltips, undo, undoDepth,
} from "/bundles/codemirror.js";

const HISTORY = { history: historyField };
const running = StateEffect.define();
const nowRunning = Decoration.line({ class: "cm-running" });

const runningLine = StateField.define({
  create: () => Decoration.none,
  update(shown, change) {
    let made = shown.map(change.changes);
    for (const effect of change.effects) {
      if (!effect.is(running)) continue;
      const line = effect.value;
      made = line > 0 && line <= change.state.doc.lines ? Decoration.set([nowRunning.range(change.state.doc.line(line).from)]) : Decoration.none;
    }
    return made;
  },
  provide: (field) => EditorView.decorations.from(field),
});

// Theme from the pages' CSS colours, which exist for light and dark mode.
export const THEME = EditorView.theme({
  "&": { height: "100%", color: "var(--ink)", backgroundColor: "var(--card)", fontSize: "15px", borderRadius: "8px" },
  "&.cm-focused": { outline: "2px solid var(--accent)", outlineOffset: "-2px" },
  ".cm-scroller": { fontFamily: "ui-monospace, 'DejaVu Sans Mono', monospace", lineHeight: "1.55", overflow: "auto" },
  ".cm-content": { caretColor: "var(--accent)", padding: "4px 0" },
  ".cm-cursor": { borderLeftColor: "var(--accent)", borderLeftWidth: "2px" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": { background: "var(--code-selection)" },
  ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "var(--code-active)" },
  ".cm-gutters": { backgroundColor: "var(--card)", color: "var(--soft)", borderRight: "1px solid var(--line)" },
  ".cm-running": { backgroundColor: "var(--code-running)", boxShadow: "inset 5px 0 var(--good)" },
  ".cm-tooltip": { backgroundColor: "var(--card)", color: "var(--ink)", border: "1px solid var(--line)", borderRadius: "8px", maxWidth: "min(480px, 38vw)" },
  ".cm-tooltip-autocomplete > ul > li": { minHeight: "38px", display: "flex", alignItems: "center" },
  ".cm-tooltip-autocomplete > ul > li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--on-accent)" },
  ".cm-said": { padding: "8px 12px", whiteSpace: "pre-wrap", maxHeight: "40vh", overflow: "auto" },
  ".cm-diagnostic": { whiteSpace: "pre-wrap", padding: "6px 10px" },
  ".cm-panels": { backgroundColor: "var(--ground)", color: "var(--ink)" },
  ".cm-panel.cm-search": { padding: "6px 44px 6px 6px" },
  ".cm-panel.cm-search input.cm-textfield, .cm-panel.cm-search button": { minHeight: "40px", font: "inherit", backgroundImage: "none", backgroundColor: "var(--key)", color: "var(--ink)", borderRadius: "6px" },
  ".cm-panel.cm-search [name=close]": { minWidth: "40px", fontSize: "1.3rem" },
});

export class Editor extends EventTarget {
  constructor(place, { editable }) {
    super();
    this.place = place;
    this.root = place.shadowRoot ?? place.attachShadow({ mode: "open" });
    this.language = new Compartment();
    this.analyst = new Compartment();
    this.editable = editable;
    this.view = new EditorView({ parent: this.root, root: this.root, state: this.fresh("") });
  }

  // Return an editor state for a text; without a history, or with the stored state `kept`.
  fresh(text, kept = null) {
    const told = EditorView.updateListener.of((update) => {
      if (update.docChanged) this.dispatchEvent(new CustomEvent("changed", { detail: update }));
      if (update.selectionSet && !update.docChanged) this.dispatchEvent(new Event("selected"));
    });
    const config = {
      extensions: [
        lineNumbers(), lintGutter(), highlightActiveLine(), highlightActiveLineGutter(), drawSelection(), history(), bracketMatching(), search({ top: true }), highlightSelectionMatches(),
        keymap.of([...completionKeymap, ...searchKeymap, ...historyKeymap, ...lintKeymap, ...defaultKeymap, indentWithTab]),
        EditorView.contentAttributes.of({ "aria-label": "Text of the program", spellcheck: "false", autocapitalize: "off", autocorrect: "off" }),
        EditorState.readOnly.of(!this.editable), EditorView.editable.of(this.editable), runningLine, THEME, told, tooltips({ tooltipSpace: () => this.place.getBoundingClientRect() }), this.language.of(this.coloured ?? []), this.analyst.of(this.said ?? []),
      ],
    };
    return kept ? EditorState.fromJSON(kept, config, HISTORY) : EditorState.create({ doc: text, ...config });
  }

  // The text with its undo history, as data that `open` accepts.
  get kept() {
    return this.view.state.toJSON(HISTORY);
  }

  open(text, kept = null) {
    this.view.setState(this.fresh(text, kept));
    this.dispatchEvent(new CustomEvent("changed", { detail: null }));
  }

  colour(extensions) {
    this.coloured = extensions;
    this.view.dispatch({ effects: this.language.reconfigure(extensions) });
  }

  // Add the analyst's features: hover texts and completion.
  help(extensions, complete) {
    this.said = [extensions, autocompletion({ override: [complete], icons: false, maxRenderedOptions: 60 })];
    this.view.dispatch({ effects: this.analyst.reconfigure(this.said) });
  }

  get doc() {
    return this.view.state.doc;
  }

  get text() {
    return this.doc.toString();
  }

  // Replace the text as one step, which the user can undo. Only the part that differs is replaced.
  become(text) {
    const old = this.text;
    const [was, is] = [old, text.replace(/\r\n?/g, "\n")];
    let from = 0;
    const most = Math.min(was.length, is.length);
    while (from < most && was[from] === is[from]) from++;
    let end = 0;
    while (end < most - from && was[was.length - 1 - end] === is[is.length - 1 - end]) end++;
    if (was !== is) this.step([{ from, to: was.length - end, insert: is.slice(from, is.length - end) }]);
  }

  // Apply edits of the server (lines and columns from 1, columns in UTF-16 units) as one step.
  apply(edits, line) {
    const at = (row, column) => {
      if (row > this.doc.lines) return this.doc.length;
      const found = this.doc.line(Math.max(row, 1));
      return Math.min(found.from + column - 1, found.to);
    };
    this.step(edits.map((one) => ({ from: at(one.line, one.column), to: at(one.end_line, one.end_column), insert: one.text.replace(/\r\n?/g, "\n") })));
    if (line) this.select(line, line);
  }

  step(changes) {
    this.view.dispatch({ changes, annotations: [isolateHistory.of("full"), Transaction.userEvent.of("input.edit")], scrollIntoView: true });
  }

  // The first and the last line of the selection, from 1.
  get lines() {
    const { from, to } = this.view.state.selection.main;
    return [this.doc.lineAt(from).number, this.doc.lineAt(to).number];
  }

  select(first, last, { focus = false } = {}) {
    const bound = (line) => Math.min(Math.max(line, 1), this.doc.lines);
    const anchor = this.doc.line(bound(first)).from;
    const head = first === last ? anchor : this.doc.line(bound(last)).to;
    this.view.dispatch({ selection: { anchor, head }, effects: EditorView.scrollIntoView(anchor, { y: "nearest", yMargin: 60 }) });
    if (focus) this.view.focus();
  }

  run(line) {
    if (this.ran === line) return;
    this.ran = line;
    this.view.dispatch({ effects: running.of(line) });
  }

  undo() {
    undo(this.view);
  }

  redo() {
    redo(this.view);
  }

  get steps() {
    return { undo: undoDepth(this.view.state) > 0, redo: redoDepth(this.view.state) > 0 };
  }

  close() {
    this.view.destroy();
  }
}
