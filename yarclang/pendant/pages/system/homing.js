// Homing: the controller's own home search, for one motor after the other, while a button is held. The search isn't
// proved.

import { order } from "/api.js";
import { button, h, put, text } from "/dom.js";
import { holdable } from "/holding.js";
import { askPin } from "/service.js";

export function homing(place, app) {
  const list = h("div", { class: "searches", role: "group", "aria-label": "Motors to home, in the order in which they are chosen" });
  const why = h("p", { class: "why", role: "status" });
  const fast = h("ul", {});
  const hold = h("button", { type: "button", class: "jog home", disabled: true }, "Hold to home");
  let chosen = [];
  let searches = [];
  let asking = false;
  let told = "";

  holdable(hold, app.holding, "home", () => ({ home: chosen.map(({ motor }) => motor) }));
  put(place,
    h("h2", {}, "Home"),
    h("div", { class: "not-proved", role: "note" },
      "Not proved. The controller searches by itself, without checking zones, obstacles or joint limits. Make sure that the whole path is free, and keep a hand at the emergency stop.", fast),
    h("div", { class: "actions" }, button("Ask the controller", () => ask(), { disabled: !app.may("operator") })),
    list, h("div", { class: "actions" }, hold), why);

  async function ask() {
    const found = await app.tried(() => order("homing"));
    if (!found) return;
    searches = found.searches;
    chosen = [];
    draw();
  }

  function draw() {
    put(list, searches.map((one) => {
      const at = chosen.indexOf(one);
      return h("div", { class: "search" },
        button(at < 0 ? `#${one.motor} ${one.joint}` : `${at + 1}. #${one.motor} ${one.joint}`, () => choose(one), { "aria-pressed": String(at >= 0), disabled: one.refused !== "" }),
        h("span", { class: one.refused ? "soft" : "" }, one.refused || `${speed(one)}, at most ${one.longest_s.toFixed(0)} s${one.homed ? " (is homed)" : ""}`));
    }));
    put(fast, chosen.map((one) => h("li", {}, `${one.joint} moves at ${speed(one)}.`)));
    told = "";
    refresh();
  }

  function choose(one) {
    chosen = chosen.includes(one) ? chosen.filter((other) => other !== one) : [...chosen, one];
    draw();
  }

  function refresh() {
    const hindered = hindrance(app, chosen);
    hold.disabled = hindered !== "";
    text(hold, chosen.length ? `Hold to home ${chosen.map(({ motor }) => `#${motor}`).join(", ")}` : "Hold to home");
    text(why, told || hindered || "Hold the button: the motors search until you release it.");
  }

  const hear = async ({ detail }) => {
    if (detail.code === "pin") {
      if (asking) return;
      asking = true;
      told = (await askPin(app)) ? "Hold the button again." : "Homing needs the PIN.";
      asking = false;
    } else told = said(detail, app.holding.moving);
    refresh();
  };
  app.holding.addEventListener("told", hear);
  app.robot.addEventListener("display", refresh);
  refresh();
  return () => {
    app.holding.releaseAll();
    app.holding.removeEventListener("told", hear);
    app.robot.removeEventListener("display", refresh);
  };
}

const speed = (one) => `${Math.abs(one.speed).toPrecision(3)} ${one.unit}/s towards ${one.speed < 0 ? "minus" : "plus"}`;

// Return the reason why no motor can be homed now; empty: one can.
function hindrance(app, chosen) {
  if (!app.may("service")) return "Homing needs the role service and the PIN.";
  if (!app.controls) return "Take control of the robot first.";
  if (app.robot.display?.enabled === false) return "Enable the motors first.";
  return chosen.length ? "" : "Choose motors in the order in which they are homed.";
}

function said({ state, why, help }, moving) {
  if (state === "reached") return "Homed.";
  if (why) return help ? `${why}: ${help}` : why;
  return moving ? "Searching. Release the button to stop." : "Stopped.";
}
