// What the pendant's pages use of CodeMirror.
export { EditorState, EditorSelection, Compartment, StateEffect, StateField, Annotation, RangeSetBuilder, Transaction } from "@codemirror/state";
export { EditorView, Decoration, keymap, lineNumbers, highlightActiveLine, highlightActiveLineGutter, drawSelection, gutter, GutterMarker, hoverTooltip, showTooltip, tooltips } from "@codemirror/view";
export { defaultKeymap, history, historyField, historyKeymap, undo, redo, undoDepth, redoDepth, indentWithTab, isolateHistory } from "@codemirror/commands";
export { StreamLanguage, HighlightStyle, syntaxHighlighting, bracketMatching } from "@codemirror/language";
export { linter, lintGutter, setDiagnostics, lintKeymap } from "@codemirror/lint";
export { autocompletion, completionKeymap } from "@codemirror/autocomplete";
export { search, searchKeymap, highlightSelectionMatches } from "@codemirror/search";
export { MergeView, unifiedMergeView } from "@codemirror/merge";
export { tags } from "@lezer/highlight";
