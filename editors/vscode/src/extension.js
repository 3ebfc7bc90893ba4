"use strict";

const path = require("path");
const { window, workspace, commands, Uri, ViewColumn } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");
const { compileArguments, pictureHtml, viewArguments, serverCommand, programOf } = require("./arguments");

let client;
let channel;

/** Start `yarc lsp`, and offer the commands. */
async function activate(context) {
  channel = window.createOutputChannel("YARC");
  context.subscriptions.push(
    channel,
    commands.registerCommand("yarc.compileProgram", () => onProgram(compile)),
    commands.registerCommand("yarc.plotProgram", () => onProgram(plot)),
    commands.registerCommand("yarc.viewProgram", () => onProgram(view)),
    commands.registerCommand("yarc.restartServer", restart),
    workspace.onDidChangeConfiguration((change) => change.affectsConfiguration("yarc") && restart()),
  );
  await start();
}

async function deactivate() {
  await client?.stop();
  client = undefined;
}

async function start() {
  const server = serverCommand(settings());
  client = new LanguageClient(
    "yarc",
    "YARC",
    { command: server.command, args: server.args, options: { cwd: workspaceFolder() } },
    {
      documentSelector: [
        { scheme: "file", language: "yarc" },
        { scheme: "untitled", language: "yarc" },
        { scheme: "file", pattern: "**/{robot,cell}.toml" },
      ],
      outputChannel: channel,
      middleware: {
        window: {
          async showDocument(params, token, next) {
            const uri = Uri.parse(params.uri);
            if (!uri.fsPath.endsWith(".svg")) {
              return next(params, token);
            }
            await showPicture(uri);
            return { success: true };
          },
        },
      },
      synchronize: { fileEvents: workspace.createFileSystemWatcher("**/*.{yarc,toml,urdf}") },
    },
  );
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    const chosen = await window.showErrorMessage(
      `${server.command} can't be started: ${error.message}. Install yarclang, or say in the settings where yarc is.`,
      "Open settings",
    );
    if (chosen) {
      await commands.executeCommand("workbench.action.openSettings", "yarc.path");
    }
  }
}

async function restart() {
  await deactivate();
  await start();
}

function settings() {
  const all = workspace.getConfiguration("yarc");
  return { path: all.get("path"), robot: all.get("robot") };
}

function workspaceFolder() {
  return workspace.workspaceFolders?.[0]?.uri.fsPath;
}

/** What the editor shows, saved, handed to `work`. */
async function onProgram(work) {
  const document = window.activeTextEditor?.document;
  const problem = programOf(document);
  if (problem) {
    window.showWarningMessage(problem);
    return;
  }
  if (document.isDirty && !(await document.save())) {
    return;
  }
  await work(document.uri);
}

/** Run a program of yarclang; its words go to the channel. Resolves to its exit status, and null if there is no such program. */
function run(command, args, cwd) {
  channel.appendLine(`> ${command} ${args.join(" ")}`);
  return new Promise((resolve) => {
    const process = require("child_process").spawn(command, args, { cwd });
    process.stdout.on("data", (data) => channel.append(data.toString()));
    process.stderr.on("data", (data) => channel.append(data.toString()));
    process.on("error", (error) => {
      channel.appendLine(error.message);
      resolve(null);
    });
    process.on("close", resolve);
  });
}

async function compile(uri) {
  const { command, args } = compileArguments(settings(), uri.fsPath);
  const status = await run(command, args, path.dirname(uri.fsPath));
  if (status === 0) {
    window.setStatusBarMessage(`${path.basename(uri.fsPath)}: compiled and certified`, 5000);
  } else {
    channel.show(true);
    window.showErrorMessage(
      status === null ? `${command} can't be started` : `${path.basename(uri.fsPath)}: nothing written`,
    );
  }
}

async function plot(uri) {
  if (!client) {
    window.showErrorMessage("yarc lsp isn't running");
    return;
  }
  // the server asks to show what it has drawn, and tells why where it can't
  await client.sendRequest("workspace/executeCommand", {
    command: "yarc.plot",
    arguments: [uri.toString()],
  });
}

/** A picture in a panel beside the program; VS Code would show the text of an SVG. */
async function showPicture(uri) {
  const name = path.basename(uri.fsPath, ".svg");
  const data = Buffer.from(await workspace.fs.readFile(uri)).toString("base64");
  const panel = window.createWebviewPanel("yarc.plot", `Plot of ${name}`, ViewColumn.Beside, {});
  panel.webview.html = pictureHtml(data);
}

async function view(uri) {
  const { command, args } = viewArguments(settings(), uri.fsPath);
  channel.show(true);
  if ((await run(command, args, path.dirname(uri.fsPath))) === null) {
    window.showErrorMessage(`${command} can't be started`);
  }
}

module.exports = { activate, deactivate };
