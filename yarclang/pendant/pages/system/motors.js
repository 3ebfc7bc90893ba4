// A table of the motors: loop, home, following error, the reason why a motor can't move, and the remedy.

import { h, mark, put, text } from "/dom.js";

const HEADS = ["Motor", "Loop", "Homed", "Following error", "Trouble"];

// Create the table. Return a function that shows the states of the motors. `remedies` adds a column with remedies.
export function motorTable(place, remedies = false) {
  let rows = [];
  return (motors) => {
    if (rows.length !== motors.length) {
      rows = motors.map(({ number }) => ({ number: h("th", { scope: "row" }, `#${number}`), loop: h("td", {}), home: h("td", {}), following: h("td", {}), trouble: h("td", {}), ...(remedies ? { remedy: h("td", { class: "remedy" }) } : {}) }));
      put(place,
        h("thead", {}, h("tr", {}, [...HEADS, ...(remedies ? ["What to do"] : [])].map((one) => h("th", { scope: "col" }, one)))),
        h("tbody", {}, rows.map((row) => h("tr", {}, Object.values(row)))));
    }
    motors.forEach((motor, at) => {
      const row = rows[at];
      text(row.loop, motor.closed_loop ? "closed" : "open");
      text(row.home, motor.homed ? "yes" : "no");
      text(row.following, motor.following === null ? "unknown" : `${motor.following.toFixed(1)} counts`);
      text(row.trouble, motor.trouble || "none");
      mark(row.trouble, "data-bad", String(motor.trouble !== ""));
      mark(row.loop, "data-bad", String(!motor.closed_loop));
      mark(row.home, "data-bad", String(!motor.homed));
      row.loop.title = motor.flags.join(", ");
      if (row.remedy) text(row.remedy, remedy(motor));
    });
  };
}

function remedy(motor) {
  const has = (flag) => motor.flags.includes(flag);
  if (has("amplifier fault")) return "Check its drive; reset it there, then enable the motor.";
  if (has("fatal following error")) return "Find out what blocked it, then enable the motor.";
  if (has("stopped on limit")) return "Jog it off the limit.";
  if (!has("activated")) return "Activate it on the controller (Ixx00).";
  if (!motor.closed_loop) return "Enable.";
  return motor.homed ? "" : "Home it.";
}
