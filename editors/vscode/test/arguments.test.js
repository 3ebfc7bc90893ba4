"use strict";

const assert = require("node:assert");
const path = require("node:path");
const test = require("node:test");
const { compileArguments, pictureHtml, programOf, serverCommand, viewArguments } = require("../src/arguments");
const manifest = require("../package.json");

test("without settings, programs are looked for on the PATH", () => {
  const none = { path: "", robot: "" };
  assert.deepStrictEqual(serverCommand(none), { command: "yarc", args: ["lsp"] });
  assert.deepStrictEqual(compileArguments(none, "a.yarc"), { command: "yarcc", args: ["a.yarc"] });
  assert.deepStrictEqual(viewArguments(none, "a.yarc"), { command: "yarc", args: ["view", "a.yarc"] });
});

test("yarcc is beside the yarc of the settings, and the robot is handed on", () => {
  const settings = { path: path.join("/opt", "venv", "bin", "yarc"), robot: "INDUSTRIAL6" };
  const { command, args } = compileArguments(settings, "a.yarc");
  assert.strictEqual(command, path.join("/opt", "venv", "bin", "yarcc"));
  assert.deepStrictEqual(args, ["a.yarc", "--robot", "INDUSTRIAL6"]);
  assert.deepStrictEqual(serverCommand(settings).args, ["lsp", "--robot", "INDUSTRIAL6"]);
  assert.strictEqual(compileArguments({ path: "yarc", robot: "" }, "a.yarc").command, "yarcc");
});

test("only a saved program can be compiled", () => {
  assert.strictEqual(programOf({ languageId: "yarc", uri: { scheme: "file" } }), "");
  assert.match(programOf({ languageId: "yarc", uri: { scheme: "untitled" } }), /save/);
  assert.match(programOf({ languageId: "python", uri: { scheme: "file" } }), /open/);
  assert.match(programOf(undefined), /open/);
});

test("a picture's page has no script", () => {
  assert.match(pictureHtml("AAAA"), /default-src 'none'/);
  assert.doesNotMatch(pictureHtml("AAAA"), /<script/);
});

test("every command of the manifest is registered, and the other way round", () => {
  const source = require("node:fs").readFileSync(path.join(__dirname, "..", "src", "extension.js"), "utf8");
  const registered = [...source.matchAll(/registerCommand\("([^"]+)"/g)].map((match) => match[1]);
  assert.deepStrictEqual(registered.sort(), manifest.contributes.commands.map((one) => one.command).sort());
});
