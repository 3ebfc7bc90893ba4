"use strict";

const { spawn } = require("child_process");

/** How a program that is waited for ended: `code` if it couldn't be started (ENOENT), else `status` and `words`, all that it printed.
 *
 * `heard` gets what it prints, as it comes; `started` gets the process. */
function run(command, args, cwd, heard = () => {}, started = () => {}) {
  return new Promise((resolve) => {
    let words = "";
    const process = spawn(command, args, { cwd });
    const hear = (data) => {
      words += data;
      heard(data.toString());
    };
    process.stdout.on("data", hear);
    process.stderr.on("data", hear);
    process.on("error", (error) => resolve({ code: error.code ?? error.message, status: null, words }));
    process.on("close", (status) => resolve({ status, words }));
    started(process);
  });
}

module.exports = { run };
