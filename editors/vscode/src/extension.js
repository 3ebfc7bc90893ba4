"use strict";

const os = require("os");
const path = require("path");
const vscode = require("vscode");
const { commands, env, window, workspace, Uri, ViewColumn } = vscode;
const { LanguageClient } = require("vscode-languageclient/node");
const {
  addressIn,
  compileArguments,
  complaint,
  lineOf,
  pictureHtml,
  places,
  programOf,
  runArguments,
  serverCommand,
  viewArguments,
} = require("./arguments");
const { run } = require("./running");
const { fitting } = require("./snippets");

let client;
let channel;
/** What the server and the client say of themselves, which only helps where they fail. */
let serverChannel;
let watcher;
/** Where yarc was found; nothing while it isn't there. */
let found = "";
/** Starts and ends of the server, one after the other. */
let changing = Promise.resolve();
/** The programs that are viewed, by file. */
const views = new Map();
/** The programs that run on simulated robots, by file. */
const runs = new Map();
/** How the line of the command looks that is carried out. */
let running;
/** The panels with pictures, by file. */
const panels = new Map();

/** Start `yarc lsp`, and offer the commands. */
async function activate(context) {
  channel = window.createOutputChannel("YARC");
  serverChannel = window.createOutputChannel("YARC language server");
  watcher = workspace.createFileSystemWatcher("**/*.{yarc,toml,urdf,csv}");
  context.subscriptions.push(
    channel,
    serverChannel,
    watcher,
    commands.registerCommand("yarc.compileProgram", () => onProgram(compile)),
    commands.registerCommand("yarc.plotProgram", () => onProgram(plot)),
    commands.registerCommand("yarc.viewProgram", () => onProgram(view)),
    commands.registerCommand("yarc.runProgram", () => onProgram(runSimulated)),
    commands.registerCommand("yarc.stopRun", () => endRun(window.activeTextEditor?.document.uri)),
    commands.registerCommand("yarc.restartServer", restart),
    workspace.onDidChangeConfiguration((change) => change.affectsConfiguration("yarc") && restart()),
    vscode.languages.registerCompletionItemProvider("yarc", { provideCompletionItems: snippets }),
  );
  running = window.createTextEditorDecorationType({
    isWholeLine: true,
    backgroundColor: new vscode.ThemeColor("editor.stackFrameHighlightBackground"),
    overviewRulerColor: new vscode.ThemeColor("editor.stackFrameHighlightBackground"),
  });
  context.subscriptions.push(running);
  await restart();
}

async function deactivate() {
  for (const one of [...views.values(), ...runs.values()]) {
    one.kill();
  }
  await stop();
}

function restart() {
  changing = changing.then(stop).then(start);
  return changing;
}

async function stop() {
  const old = client;
  client = undefined;
  await old?.stop().catch(() => {}); // one that has ended by itself
}

async function start() {
  const problem = await find();
  if (problem) {
    complain(problem);
    return;
  }
  const server = serverCommand(settings());
  const starting = new LanguageClient(
    "yarc",
    "YARC",
    { command: server.command, args: server.args, options: { cwd: workspaceFolder() } },
    {
      documentSelector: [
        { scheme: "file", language: "yarc" },
        { scheme: "untitled", language: "yarc" },
        { scheme: "file", pattern: "**/{robot,cell}.toml" },
      ],
      outputChannel: serverChannel,
      middleware: { window: { showDocument } },
      synchronize: { fileEvents: watcher },
    },
  );
  try {
    await starting.start();
    client = starting;
  } catch (error) {
    serverChannel.appendLine(String(error?.message ?? error)); // the client has said that it failed, with a way to this channel
  }
}

/** Look for yarc. What is wrong, in words, or nothing. */
async function find() {
  const setting = workspace.getConfiguration("yarc").get("path");
  let problem = "";
  for (const command of places(setting, workspaceFolder(), os.homedir())) {
    const outcome = await run(command, ["lsp", "--help"], workspaceFolder());
    const wrong = complaint(setting, command, outcome);
    if (!wrong) {
      found = command;
      return "";
    }
    if (!problem || outcome.code !== "ENOENT") {
      problem = wrong; // a yarc that is there and too old says more than one that isn't there
    }
  }
  found = "";
  return problem;
}

/** Say what is wrong with yarc, and offer to change the settings. Nobody waits for the answer: commands go on. */
function complain(problem) {
  channel.appendLine(problem);
  window.showErrorMessage(problem, "Open settings").then((chosen) => {
    if (chosen) {
      const place = env.remoteName ? "workbench.action.openRemoteSettings" : "workbench.action.openSettings";
      commands.executeCommand(place, { query: "@id:yarc.path" });
    }
  });
}

/** The settings, with yarc where it was found. */
function settings() {
  return { path: found, robot: workspace.getConfiguration("yarc").get("robot") };
}

function workspaceFolder() {
  return workspace.workspaceFolders?.[0]?.uri.fsPath;
}

/** The snippets, as long as no server completes: it has them with the robot's joints and the next index. */
function snippets(document, position) {
  if (client) {
    return [];
  }
  return fitting(document.lineAt(position).text.slice(0, position.character)).map(([word, body, description]) => {
    const item = new vscode.CompletionItem(word, vscode.CompletionItemKind.Snippet);
    item.insertText = new vscode.SnippetString(body);
    item.detail = description;
    return item;
  });
}

/** What the editor shows, saved, handed to `use`. */
async function onProgram(use) {
  const document = window.activeTextEditor?.document;
  const problem = programOf(document);
  if (problem) {
    window.showWarningMessage(problem);
    return;
  }
  if (document.isDirty && !(await document.save())) {
    return;
  }
  if (!found) {
    const missing = await find();
    if (missing) {
      complain(missing);
      return;
    }
    restart(); // it has come since
  }
  await use(document.uri);
}

/** Run a program of yarclang; its words go to the channel. */
function runHeard({ command, args }, uri, heard = () => {}, started = undefined) {
  channel.appendLine(`> ${command} ${args.join(" ")}`);
  const hear = (words) => {
    channel.append(words);
    heard(words);
  };
  return run(command, args, path.dirname(uri.fsPath), hear, started);
}

async function compile(uri) {
  const name = path.basename(uri.fsPath);
  const compiler = compileArguments(settings(), uri.fsPath);
  const outcome = await waitingFor(`compiling ${name}`, () => runHeard(compiler, uri));
  if (outcome.status === 0) {
    window.setStatusBarMessage(`$(check) ${name}: compiled and certified`, 8000);
    return;
  }
  channel.show(true);
  window.showErrorMessage(
    outcome.code
      ? `${compiler.command} can't be started: ${outcome.code}`
      : `${name}: nothing written`,
  );
}

async function plot(uri) {
  await changing;
  if (!client) {
    window.showErrorMessage("The language server isn't running. YARC: Restart the language server starts it.");
    return;
  }
  // the server asks to show what it has drawn, and tells why where it can't
  await waitingFor("plotting", () =>
    client.sendRequest("workspace/executeCommand", { command: "yarc.plot", arguments: [uri.toString()] }),
  );
}

/** Show what the server has made, beside the program: pictures in panels of their own, texts as texts. */
async function showDocument(params) {
  const uri = Uri.parse(params.uri);
  if (uri.fsPath.endsWith(".svg")) {
    await showPicture(uri);
  } else {
    await window.showTextDocument(uri, { viewColumn: ViewColumn.Beside, preserveFocus: !params.takeFocus });
  }
  return { success: true };
}

/** A picture in a panel beside the program, the same one each time; VS Code would show the text of an SVG. */
async function showPicture(uri) {
  const name = path.basename(uri.fsPath, ".svg");
  const data = Buffer.from(await workspace.fs.readFile(uri)).toString("base64");
  let panel = panels.get(name);
  if (panel) {
    panel.reveal(undefined, true);
  } else {
    const column = { viewColumn: ViewColumn.Beside, preserveFocus: true };
    panel = window.createWebviewPanel("yarc.plot", `Plot of ${name}`, column, {});
    panel.onDidDispose(() => panels.delete(name));
    panels.set(name, panel);
  }
  panel.webview.html = pictureHtml(data);
}

/** Show a program in the browser, in place of what is shown of it. */
async function view(uri) {
  const name = path.basename(uri.fsPath);
  views.get(uri.fsPath)?.kill();
  let words = "";
  let address;
  let viewer;
  const opened = new Promise((resolve) => {
    const heard = (piece) => {
      words += piece;
      if (!address && (address = addressIn(words))) {
        env.openExternal(Uri.parse(address));
        resolve();
      }
    };
    const started = (process) => {
      viewer = process;
      views.set(uri.fsPath, viewer);
    };
    runHeard(viewArguments(settings(), uri.fsPath), uri, heard, started).then((outcome) => {
      resolve();
      if (views.get(uri.fsPath) === viewer) {
        views.delete(uri.fsPath);
      }
      if (outcome.code || outcome.status) {
        channel.show(true);
        window.showErrorMessage(`${name} can't be shown`);
      }
    });
  });
  await waitingFor(`opening ${name} in the browser`, () => opened);
}

/** Run a program on a simulated robot, with the line lit that is carried out; the run before ends first. */
async function runSimulated(uri) {
  const name = path.basename(uri.fsPath);
  runs.get(uri.fsPath)?.kill();
  let simulator;
  let rest = "";
  const heard = (piece) => {
    const lines = (rest + piece).split("\n");
    rest = lines.pop();
    for (const line of lines) {
      light(uri, line);
    }
  };
  const started = (process) => {
    simulator = process;
    runs.set(uri.fsPath, simulator);
  };
  const outcome = await waitingFor(`running ${name} on a simulated robot`, () =>
    runHeard(runArguments(settings(), uri.fsPath), uri, heard, started),
  );
  if (runs.get(uri.fsPath) !== simulator) {
    return; // another run has begun
  }
  runs.delete(uri.fsPath);
  light(uri, undefined);
  if (outcome.status === 0) {
    window.setStatusBarMessage(`$(check) ${name}: done`, 8000);
  } else if (outcome.code || outcome.status) {
    channel.show(true);
    window.showErrorMessage(outcome.code ? `yarc can't be started: ${outcome.code}` : `${name} didn't run to its end`);
  }
}

/** Light the line of the command that the words of a run name; without words, none. */
function light(uri, words) {
  for (const editor of window.visibleTextEditors) {
    if (editor.document.uri.fsPath !== uri.fsPath) {
      continue;
    }
    if (words === undefined) {
      editor.setDecorations(running, []);
      continue;
    }
    const line = lineOf(words, editor.document.getText());
    if (line !== undefined) {
      const range = editor.document.lineAt(line).range;
      editor.setDecorations(running, [range]);
      editor.revealRange(range, vscode.TextEditorRevealType.InCenterIfOutsideViewport);
    }
  }
}

/** End the run of a program: a simulated robot has nothing to bring to rest. */
function endRun(uri) {
  if (uri) {
    runs.get(uri.fsPath)?.kill();
  }
}

/** What is under way, in the status bar until it is done. */
function waitingFor(what, work) {
  return window.withProgress({ location: vscode.ProgressLocation.Window, title: `YARC: ${what}` }, work);
}

module.exports = { activate, deactivate };
