"use strict";

const fs = require("fs");
const path = require("path");

/** The snippets as [word, body, description]. */
function read() {
  const text = fs.readFileSync(path.join(__dirname, "..", "snippets", "yarc.json"), "utf8");
  return Object.entries(JSON.parse(text)).map(([word, one]) => [word, one.body.join("\n"), one.description]);
}

/** Which snippets fit behind what stands in a line: commands have an index, which isn't written twice, and nothing but an index may stand before. */
function fitting(before) {
  const head = before.match(/^\s*(P\d+\s+)?[A-Za-z_]*$/i);
  if (!head) {
    return [];
  }
  const all = read();
  if (!head[1]) {
    return all;
  }
  return all.filter(([, body]) => /^P\d+ /.test(body)).map(([word, body, ...rest]) => [word, body.replace(/^P\d+ /, ""), ...rest]);
}

module.exports = { fitting };
