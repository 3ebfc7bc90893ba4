"use strict";

const assert = require("node:assert");
const path = require("node:path");
const test = require("node:test");
const {
  addressIn,
  compileArguments,
  complaint,
  lineOf,
  pictureHtml,
  places,
  programOf,
  serverCommand,
  viewArguments,
} = require("../src/arguments");
const { run } = require("../src/running");
const { fitting } = require("../src/snippets");
const manifest = require("../package.json");

test("without settings, programs are looked for on the PATH", () => {
  const none = { path: "", robot: "" };
  assert.deepStrictEqual(serverCommand(none), { command: "yarc", args: ["lsp"] });
  assert.deepStrictEqual(compileArguments(none, "a.yarc"), { command: "yarcc", args: ["a.yarc"] });
  assert.deepStrictEqual(viewArguments(none, "a.yarc"), {
    command: "yarc",
    args: ["view", "a.yarc", "--port", "0", "--no-browser"],
  });
});

test("yarcc is beside the yarc of the settings, and the robot is handed on", () => {
  const settings = { path: path.join("/opt", "venv", "bin", "yarc"), robot: "INDUSTRIAL6" };
  const { command, args } = compileArguments(settings, "a.yarc");
  assert.strictEqual(command, path.join("/opt", "venv", "bin", "yarcc"));
  assert.deepStrictEqual(args, ["a.yarc", "--robot", "INDUSTRIAL6"]);
  assert.deepStrictEqual(serverCommand(settings).args, ["lsp", "--robot", "INDUSTRIAL6"]);
  assert.strictEqual(compileArguments({ path: "yarc", robot: "" }, "a.yarc").command, "yarcc");
});

test("yarc is looked for on the PATH and in .venv, or where the settings say", () => {
  assert.deepStrictEqual(places("", "/cell", "/people/me"), ["yarc", "/cell/.venv/bin/yarc"]);
  assert.deepStrictEqual(places("", undefined, "/people/me"), ["yarc"]);
  assert.deepStrictEqual(places("~/venv/bin/yarc", "/cell", "/people/me"), ["/people/me/venv/bin/yarc"]);
  assert.deepStrictEqual(places("venv/bin/yarc", "/cell", "/people/me"), ["/cell/venv/bin/yarc"]);
  assert.deepStrictEqual(places("/opt/bin/yarc", "/cell", "/people/me"), ["/opt/bin/yarc"]);
  assert.deepStrictEqual(places("yarc-next", "/cell", "/people/me"), ["yarc-next"]);
});

test("a yarc that is absent, no program, or too old gets one sentence that says what to do", async () => {
  const trial = async (setting, command, args) => complaint(setting, command, await run(command, args, __dirname));
  assert.match(await trial("", "no-such-yarc", []), /^yarc isn't found.* Install yarclang, or say in the setting yarc.path/);
  assert.match(await trial("/no/yarc", "/no/yarc", []), /^\/no\/yarc isn't there. Correct the setting yarc.path/);
  assert.match(await trial(__dirname, __dirname, []), /can't be started: it is no program/);
  const old = "console.error('Usage: yarc'); console.error('Error: No such command lsp.'); process.exit(2)";
  assert.match(await trial("", process.execPath, ["-e", old]), /no language server \(Error: No such command lsp\.\).*newer/);
  assert.match(await trial("", process.execPath, ["-e", "process.exit(1)"]), /it ended with status 1/);
  assert.strictEqual(await trial("", process.execPath, ["-e", ""]), "");
});

test("what a program prints is heard as it comes", async () => {
  const heard = [];
  const print = "process.stdout.write('one'); process.stderr.write('two')";
  const outcome = await run(process.execPath, ["-e", print], __dirname, (words) => heard.push(words));
  assert.strictEqual(outcome.status, 0);
  assert.deepStrictEqual(heard.sort(), ["one", "two"]);
});

test("the address of a view is found in what is printed", () => {
  const address = "http://127.0.0.1:34203";
  assert.strictEqual(addressIn(`a.yarc is shown at ${address} (Ctrl-C ends)\n`), address);
  assert.strictEqual(addressIn("a.yarc is shown at http://127.0"), undefined);
  assert.strictEqual(addressIn("nothing"), undefined);
});

test("snippets stand where a line begins, without a second index", () => {
  const words = (before) => fitting(before).map(([word]) => word);
  assert.deepStrictEqual(words("").includes("MOVEL") && words("").includes("FRAME"), true);
  assert.deepStrictEqual(words("  P0010 MOV").includes("MOVEL") && !words("P0010 ").includes("FRAME"), true);
  assert.deepStrictEqual(words("P0010 MOVEL 1"), []);
  const body = (before) => fitting(before).find(([word]) => word === "MOVEL")[1];
  assert.match(body(""), /^P0010 MOVEL/);
  assert.match(body("P0070 "), /^MOVEL/);
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

test("the line of a run is that of the innermost command in the file, else that of the call", () => {
  const text = "P0010 MOVEJ HOME\n  P0020 CALL PALLET.PUT\nP30 HOLD\n";
  assert.strictEqual(lineOf("P0010 MOVEJ  0.0 s to 1.0 s", text), 0);
  assert.strictEqual(lineOf("P0020>P0990(I=2) MOVEL  0.0 s", text), 1);
  assert.strictEqual(lineOf("P0030 HOLD", text), 2);
  assert.strictEqual(lineOf("P0300 HOLD", text), undefined);
  assert.strictEqual(lineOf("init: loading", text), undefined);
});
