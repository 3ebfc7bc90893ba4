"use strict";
// The extension in an editor made of a few functions: what is told, what is started, what waits for what.

const assert = require("node:assert");
const fs = require("node:fs");
const Module = require("node:module");
const os = require("node:os");
const path = require("node:path");
const test = require("node:test");

/** The extension with an editor whose setting yarc.path is `yarcPath`; `seen` has what it did. */
function extension(yarcPath) {
  const seen = { status: [], errors: [], clients: [], registered: new Map(), shown: [] };
  const disposable = { dispose() {} };
  const vscode = {
    CompletionItem: class {},
    CompletionItemKind: {},
    ProgressLocation: {},
    SnippetString: class {},
    TextEditorRevealType: {},
    ThemeColor: class {},
    Uri: { parse: (text) => ({ fsPath: new URL(text).pathname }) },
    ViewColumn: { Beside: -2 },
    commands: { registerCommand: (name, run) => (seen.registered.set(name, run), disposable) },
    env: {},
    languages: {
      registerCompletionItemProvider: (_, provider) => ((seen.snippets = provider.provideCompletionItems), disposable),
    },
    window: {
      createTextEditorDecorationType: () => disposable,
      setStatusBarMessage: (message) => seen.status.push(message),
      visibleTextEditors: [],
      createOutputChannel: () => ({ append() {}, appendLine() {}, show() {} }),
      showErrorMessage: (message) => (seen.errors.push(message), new Promise(() => {})), // nobody answers
      showTextDocument: async (uri, options) => seen.shown.push([uri.fsPath, options.viewColumn]),
      withProgress: (_, work) => work(),
    },
    workspace: {
      createFileSystemWatcher: () => disposable,
      getConfiguration: () => ({ get: (key) => (key === "path" ? yarcPath : "") }),
      onDidChangeConfiguration: (changed) => ((seen.changed = changed), disposable),
    },
  };
  class LanguageClient {
    constructor(_id, _name, server, options) {
      Object.assign(this, { server, options, running: false });
      seen.clients.push(this);
    }
    async start() {
      this.running = true;
    }
    async stop() {
      this.running = false;
    }
  }
  const load = Module._load;
  Module._load = (name, ...rest) =>
    name === "vscode" ? vscode : name === "vscode-languageclient/node" ? { LanguageClient } : load(name, ...rest);
  try {
    const file = require.resolve("../src/extension");
    delete require.cache[file];
    return { ...require(file), vscode, seen };
  } finally {
    Module._load = load;
  }
}

/** A file that is run as yarc. */
function script(context, lines) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "yarc-"));
  context.after(() => fs.rmSync(folder, { recursive: true }));
  const file = path.join(folder, "yarc");
  fs.writeFileSync(file, `#!/bin/sh\n${lines}\n`, { mode: 0o755 });
  return file;
}

const line = (text) => [{ lineAt: () => ({ text }) }, { line: 0, character: text.length }];

test("without yarc, one message is shown, nobody waits for its answer, and snippets are there", async () => {
  const { activate, seen } = extension("/no/such/yarc");
  await activate({ subscriptions: [] });
  assert.deepStrictEqual(seen.errors, ["/no/such/yarc isn't there. Correct the setting yarc.path."]);
  assert.strictEqual(seen.clients.length, 0);
  assert.notStrictEqual(seen.snippets(...line("P0010 MOV")).length, 0);
});

test("the server is started, and completes alone", async (context) => {
  const yarc = script(context, "exit 0");
  const { activate, seen } = extension(yarc);
  await activate({ subscriptions: [] });
  assert.deepStrictEqual(seen.errors, []);
  assert.deepStrictEqual([seen.clients[0].server.command, seen.clients[0].server.args], [yarc, ["lsp"]]);
  assert.deepStrictEqual(seen.snippets(...line("P0010 MOV")), []);
});

test("changes of the settings follow on each other: one server is left", async (context) => {
  const { activate, deactivate, seen } = extension(script(context, "exit 0"));
  await activate({ subscriptions: [] });
  const change = { affectsConfiguration: (section) => section === "yarc" };
  await Promise.all([seen.changed(change), seen.changed(change), seen.registered.get("yarc.restartServer")()]);
  assert.deepStrictEqual(seen.clients.map((one) => one.running), [false, false, false, true]);
  await deactivate();
  assert.ok(!seen.clients.at(-1).running);
});

test("what the server has written is shown beside the program", async (context) => {
  const { activate, vscode, seen } = extension(script(context, "exit 0"));
  await activate({ subscriptions: [] });
  const { showDocument } = seen.clients[0].options.middleware.window;
  const result = await showDocument({ uri: "file:///shown/a_4.txt", takeFocus: false }, () => assert.fail());
  assert.deepStrictEqual(result, { success: true });
  assert.deepStrictEqual(seen.shown, [["/shown/a_4.txt", vscode.ViewColumn.Beside]]);
});

test("a program runs on a simulated robot, with the line lit that is carried out", async (context) => {
  const yarc = script(context, 'echo "INDUSTRIAL6 is simulated"; echo "P0020(I=1)>P0030 DMOVEJ  1.0 s to 2.0 s of 5.5 s"; echo "P0010 MOVEJ  2.0 s"');
  const { activate, vscode, seen } = extension(yarc);
  await activate({ subscriptions: [] });
  const file = path.join(path.dirname(yarc), "a.yarc");
  const text = "SUB GO\n  P0030 DMOVEJ 1 0 0 0 0 0\nEND\np10 MOVEJ HOME\nP0020 CALL GO\n";
  const document = {
    uri: { fsPath: file, scheme: "file" },
    languageId: "yarc",
    isDirty: false,
    isUntitled: false,
    fileName: file,
    getText: () => text,
    lineAt: (line) => ({ range: line }),
  };
  const lit = [];
  const editor = { document, setDecorations: (_, ranges) => lit.push(...(ranges.length ? ranges : ["none"])), revealRange() {} };
  vscode.window.activeTextEditor = editor;
  vscode.window.visibleTextEditors = [editor];
  await seen.registered.get("yarc.runProgram")();
  assert.deepStrictEqual(lit, [1, 3, "none"]);
  assert.deepStrictEqual(seen.status, ["$(check) a.yarc: done"]);
});
