// Syntax colouring of programs, with the same kinds of words as the Pygments lexer. The server provides the words of
// the language.

import { get } from "/api.js";
import { HighlightStyle, StreamLanguage, syntaxHighlighting, tags } from "/bundles/codemirror.js";

const PIECE =
  /(?<blank>[ \t]+)|(?<comment>![^]*)|(?<string>"[^"]*"?)|(?<frame>\{[^{}!"]*\})|(?<variable>\$[A-Za-z_][A-Za-z0-9_.]*)|(?<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![A-Za-z_]))|(?<word>[A-Za-z_][A-Za-z0-9_.]*)|(?<operator><>|<=|>=|\*\*|[-+*/%=<>])|(?<mark>\$?\(|[)[\];,])|(?<wrong>[^])/gu;

const TAGS = {
  comment: tags.lineComment,
  string: tags.string,
  frame: tags.namespace,
  variable: tags.variableName,
  number: tags.number,
  operator: tags.operator,
  mark: tags.punctuation,
  wrong: tags.invalid,
  index: tags.labelName,
  unit: tags.typeName,
  block: tags.keyword,
  declaration: tags.definitionKeyword,
  command: tags.macroName,
  suffix: tags.modifier,
  builtin: tags.standard(tags.variableName),
  option: tags.attributeName,
  logic: tags.operatorKeyword,
  constant: tags.atom,
  name: tags.name,
};

const STYLE = HighlightStyle.define([
  { tag: tags.lineComment, color: "var(--code-comment)", fontStyle: "italic" },
  { tag: tags.string, color: "var(--code-string)" },
  { tag: tags.namespace, color: "var(--code-frame)" },
  { tag: [tags.variableName, tags.standard(tags.variableName)], color: "var(--code-variable)" },
  { tag: [tags.number, tags.atom], color: "var(--code-number)" },
  { tag: [tags.operator, tags.punctuation, tags.labelName], color: "var(--code-mark)" },
  { tag: [tags.typeName, tags.attributeName, tags.modifier], color: "var(--code-unit)" },
  { tag: [tags.keyword, tags.definitionKeyword, tags.operatorKeyword], color: "var(--code-keyword)", fontWeight: "600" },
  { tag: tags.macroName, color: "var(--code-command)", fontWeight: "600" },
  { tag: tags.invalid, color: "var(--bad)" },
]);

const either = (words) => words.map((one) => one.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("|");

// Return a function that splits a line into pieces: [end, kind].
export function pieces(words) {
  const units = new RegExp(`(?<!\\$)\\(\\s*(?:${either(words.units)})\\s*(?:,\\s*(?:${either(words.units)})\\s*)*\\)`, "gi");
  const command = new RegExp(`^(${either(words.commands)})((?:_(?:${either(words.suffixes)}))*)$`);
  const heads = new Map([...words.declarations.map((one) => [one, "declaration"]), ...words.blocks.map((one) => [one, "block"])]);
  const [options, logic, functions] = [words.options, words.operators, words.functions].map((one) => new Set(one));
  const constants = new Set([...words.constants, "MIN", "V"]);

  function other(upper, rest) {
    if (functions.has(upper) && /^\s*\(/.test(rest)) return "builtin";
    if (options.has(upper)) return "option";
    if (logic.has(upper)) return "logic";
    return constants.has(upper) ? "constant" : "name";
  }

  return (line) => {
    const found = [];
    const inUnits = [...line.matchAll(units)].map((one) => [one.index, one.index + one[0].length]);
    let first = true;
    let indexed = false;
    for (const one of line.matchAll(PIECE)) {
      const start = one.index;
      const end = start + one[0].length;
      const group = Object.keys(one.groups).find((name) => one.groups[name] !== undefined);
      if (group !== "word") {
        found.push([end, group === "blank" ? null : group]);
        first &&= group === "blank" || group === "comment";
        continue;
      }
      const upper = one[0].toUpperCase();
      const parts = command.exec(upper);
      if (first && /^P[0-9]+$/.test(upper)) {
        found.push([end, "index"]);
        indexed = true;
      } else if (inUnits.some(([from, to]) => from < start && start < to)) found.push([end, "unit"]);
      else if (first && !indexed && heads.has(upper)) found.push([end, heads.get(upper)]);
      else if (parts) {
        found.push([start + parts[1].length, "command"]);
        if (parts[2]) found.push([end, "suffix"]);
      } else found.push([end, other(upper, line.slice(end))]);
      first &&= indexed && upper.startsWith("P");
    }
    return found;
  };
}

let known = null;

// Return the editor extensions for syntax colouring; without the server's words, none.
export async function language() {
  known ??= get("/api/language").catch(() => (known = null));
  const words = await known;
  if (!words) return [];
  const parse = pieces(words);
  const stream = StreamLanguage.define({
    name: "yarc",
    startState: () => ({ pieces: [], next: 0 }),
    copyState: (state) => ({ ...state }),
    token(line, state) {
      if (line.sol()) Object.assign(state, { pieces: parse(line.string), next: 0 });
      const [end, kind] = state.pieces[state.next++] ?? [line.string.length, null];
      line.pos = end;
      return kind;
    },
    tokenTable: TAGS,
    languageData: { commentTokens: { line: "!" } },
  });
  return [stream, syntaxHighlighting(STYLE)];
}
