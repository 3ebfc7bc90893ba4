"use strict";

const path = require("path");

/** The program `yarc` or `yarcc`: beside the one that the settings name, else on the PATH. */
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

/** How a program is viewed with its robot. */
function viewArguments(settings, file) {
  return { command: settings.path || "yarc", args: ["view", file, ...robot(settings)] };
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

/** A page with an SVG (base64) and nothing else: no script, nothing from elsewhere. */
function pictureHtml(data) {
  const policy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";
  return `<!DOCTYPE html><html><head><meta http-equiv="Content-Security-Policy" content="${policy}"></head>
<body style="background: white"><img style="max-width: 100%" src="data:image/svg+xml;base64,${data}"></body></html>`;
}

module.exports = { pictureHtml, serverCommand, compileArguments, viewArguments, programOf };
