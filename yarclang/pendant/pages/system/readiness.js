// The robot's readiness: the reason why it can't move, and the buttons that remedy this: connect, enable, clear. Also a
// button to disable the motors.

import { order } from "/api.js";
import { button, h, mark, put, text } from "/dom.js";
import { asked } from "/system/asked.js";

// Show the readiness in a place. `compare` is called after enabling, if further checks prevent motion. Return the
// functions `refresh` (for the display) and `hear` (for the health).
export function readiness(place, app, compare) {
  const ready = h("p", { class: "ready", role: "status" });
  const hindered = h("p", { class: "soft" });
  const connect = button("Connect now", () => app.tried(() => order("connect")));
  const enabling = button("Enable motors", () => enable());
  const clearing = button("Clear the fault", () => app.tried(() => order("clear")));
  const disabling = button("Disable motors", () => disable());
  const owned = [
    enabling,
    clearing,
    disabling,
  ];
  let link = "";
  let isOpen = false;
  let areClosed = true;
  put(place, ready, h("div", { class: "actions" }, connect, owned), hindered);

  async function enable() {
    const told = await app.tried(() => order("enable"));
    if (!told) return;
    if (told.what) app.notice(told.what, true);
    else app.notice(told.wrong.length ? `All loops are closed; ${told.wrong.length} more checks prevent motion.` : "All loops are closed: the robot is ready.");
    if (told.wrong.length) compare();
  }

  async function disable() {
    const what = h("p", {}, "All loops are opened. Then only the machine's brakes hold the arm: an axis without a brake falls.");
    if (!(await asked(place, "Disable the motors?", what, "Disable"))) return;
    const told = await app.tried(() => order("disable"));
    if (told?.what) app.notice(told.what, true);
  }

  function refresh() {
    const display = app.robot.display;
    if (!display) return;
    const why = hindrance(display, link);
    text(ready, why ? `Not ready: ${why}.` : display.under_way ? `Ready: ${display.under_way} is under way.` : "Ready.");
    mark(ready, "data-good", String(!why));
    const what = !app.may("operator") ? "This needs the role operator." : !app.controls ? "Take control of the robot first." : display.under_way ? `${display.under_way} is under way.` : "";
    text(hindered, what);
    for (const one of owned) one.disabled = what !== "" || link !== "";
    connect.hidden = !link;
    connect.disabled = !app.may("operator");
    disabling.hidden = isOpen;
    enabling.classList.toggle("main", !areClosed);
    clearing.classList.toggle("main", areClosed && display.mode === "fault");
  }

  function hear(health) {
    link = health.link;
    isOpen = health.motors.every((motor) => !motor.closed_loop);
    areClosed = health.motors.every((motor) => motor.closed_loop);
    refresh();
  }

  return { refresh, hear };
}

// Return the reason why the robot can't move; empty: there is none.
function hindrance(display, link) {
  if (!display.connected) return "the coordinator of the robot can't be reached";
  if (link) return `there is no connection to the controller: ${link}`;
  return ["fault", "disconnected"].includes(display.mode) ? display.why || "it wasn't checked yet" : "";
}
