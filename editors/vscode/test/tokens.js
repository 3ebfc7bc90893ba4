"use strict";
// The grammar as VS Code reads it: `node tokens.js FILE...` prints, as JSON, the pieces of each file with their innermost scopes.

const fs = require("fs");
const path = require("path");
const { loadWASM, OnigScanner, OnigString } = require("vscode-oniguruma");
const { INITIAL, Registry, parseRawGrammar } = require("vscode-textmate");

const grammarFile = path.join(__dirname, "..", "syntaxes", "yarc.tmLanguage.json");

async function loadGrammar() {
  const wasm = path.join(path.dirname(require.resolve("vscode-oniguruma")), "onig.wasm");
  await loadWASM(fs.readFileSync(wasm).buffer);
  const registry = new Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new OnigScanner(patterns),
      createOnigString: (text) => new OnigString(text),
    }),
    loadGrammar: async () => parseRawGrammar(fs.readFileSync(grammarFile, "utf8"), grammarFile),
  });
  return registry.loadGrammar("source.yarc");
}

/** Lines of [start, end, innermost scope without `.yarc`] of what isn't blank. */
function tokens(grammar, text) {
  let state = INITIAL;
  return text.split("\n").map((line) => {
    const result = grammar.tokenizeLine(line, state);
    state = result.ruleStack;
    return result.tokens
      .map((one) => [one.startIndex, Math.min(one.endIndex, line.length), one.scopes.at(-1).replace(/\.yarc$/, "")])
      .filter(([start, end]) => /[^ \t]/.test(line.slice(start, end)));
  });
}

module.exports = { loadGrammar, tokens };

if (require.main === module) {
  loadGrammar().then((grammar) => {
    const all = process.argv.slice(2).map((file) => tokens(grammar, fs.readFileSync(file, "utf8")));
    process.stdout.write(JSON.stringify(all));
  });
}
