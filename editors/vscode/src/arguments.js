"use strict";

const path = require("path");

/** Where `yarc` may be, the likeliest first: what the settings say, else on the PATH or in the folder's own environment. */
function places(setting, folder, home) {
  if (!setting) {
    return folder ? ["yarc", path.join(folder, ".venv", "bin", "yarc")] : ["yarc"];
  }
  const whole = /^~(?=$|[/\\])/.test(setting) ? home + setting.slice(1) : setting;
  return [path.dirname(whole) === "." || !folder ? whole : path.resolve(folder, whole)];
}

/** What is wrong with a `yarc`, and what to do; nothing if it is the one that is wanted. `outcome` tells how `yarc lsp --help` ended. */
function complaint(setting, command, outcome) {
  const remedy = "say in the setting yarc.path where yarc is.";
  if (outcome.code === "ENOENT") {
    return setting
      ? `${command} isn't there. Correct the setting yarc.path.`
      : `yarc isn't found, neither on the PATH nor in .venv of this folder. Install yarclang, or ${remedy}`;
  }
  if (outcome.code) {
    const why = outcome.code === "EACCES" ? "it is no program that may be run" : outcome.code;
    return `${command} can't be started: ${why}. Install yarclang, or ${remedy}`;
  }
  if (outcome.status !== 0) {
    const words = outcome.words.trim().split("\n").at(-1).slice(0, 200) || `it ended with status ${outcome.status}`;
    return `${command} has no language server (${words}). It may be too old: install a newer yarclang, or ${remedy}`;
  }
  return "";
}

/** The program `yarc` or `yarcc`: beside the one that was found, else on the PATH. */
function program(settings, name) {
  if (!settings.path) {
    return name;
  }
  const folder = path.dirname(settings.path);
  return folder === "." ? name : path.join(folder, name);
}

function robot(settings) {
  return settings.robot ? ["--robot", settings.robot] : [];
}

/** How the language server is started. */
function serverCommand(settings) {
  return { command: settings.path || "yarc", args: ["lsp", ...robot(settings)] };
}

/** How a program is compiled. */
function compileArguments(settings, file) {
  return { command: program(settings, "yarcc"), args: [file, ...robot(settings)] };
}

/** How a program is run on a simulated robot. */
function runArguments(settings, file) {
  return { command: settings.path || "yarc", args: ["run", file, "--no-log", ...robot(settings)] };
}

/** The line, from 0, of the command that is carried out, as `yarc run` says it: `P0020(I=2)>P0030 DMOVEJ  1.0 s to 2.0 s of 5.5 s`.
 *
 * Of a command in a SUB of this file it is that line; in a module's, the line of the CALL. Nothing if the words name no command of the text. */
function lineOf(words, text) {
  const said = /^(?<way>P\d+\S*)\s/.exec(words);
  if (!said) {
    return undefined;
  }
  const indices = said.groups.way.split(">").map((part) => /P\d+/.exec(part)?.[0]).filter(Boolean);
  const lines = text.split(/\r\n|\r|\n/);
  for (const index of indices.reverse()) {
    const wanted = new RegExp(`^\\s*P0*${Number(index.slice(1))}(?!\\S)`, "i");
    const line = lines.findIndex((one) => wanted.test(one));
    if (line >= 0) {
      return line;
    }
  }
  return undefined;
}

/** How a program is viewed with its robot: on a free port, since another one may be viewed. */
function viewArguments(settings, file) {
  return {
    command: settings.path || "yarc",
    args: ["view", file, "--port", "0", "--no-browser", ...robot(settings)],
  };
}

/** The first whole address in what a program prints; nothing if there is none yet. */
function addressIn(words) {
  return words.match(/http:\/\/\S+(?=\s)/)?.[0];
}

/** Why a document is no program that can be compiled; nothing if it is one. */
function programOf(document) {
  if (!document || document.languageId !== "yarc") {
    return "open a YARC program (.yarc) first";
  }
  if (document.uri.scheme !== "file") {
    return "save the program to a file first";
  }
  return "";
}

/** A page with an SVG (base64) and nothing else: no script, nothing from elsewhere. In a narrow panel it is wider than the panel: its words stay readable. */
function pictureHtml(data) {
  const policy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";
  return `<!DOCTYPE html><html><head><meta http-equiv="Content-Security-Policy" content="${policy}"></head>
<body style="background: white"><img style="width: max(100%, 1000px); max-width: none; max-height: none" src="data:image/svg+xml;base64,${data}"></body></html>`;
}

module.exports = {
  addressIn,
  compileArguments,
  complaint,
  pictureHtml,
  places,
  lineOf,
  programOf,
  runArguments,
  serverCommand,
  viewArguments,
};
