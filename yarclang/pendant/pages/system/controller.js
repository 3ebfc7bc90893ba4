// The page Controller: what prevents the robot from moving, and the remedies (enable, home, settings); restart and
// shutdown.

import { order } from "/api.js";
import { h, put } from "/dom.js";
import { ending } from "/system/ending.js";
import { homing } from "/system/homing.js";
import { motorTable } from "/system/motors.js";
import { readiness } from "/system/readiness.js";
import { settings } from "/system/settings.js";

const EACH = 500;
const LOOKED_EACH = 10000;

export function controllerPage(place, app) {
  styled();
  const table = h("table", { class: "motors" });
  const section = (kind = "") => h("section", { class: kind || null });
  const [top, home, pendant, compared] = [section("wide"), section(), section(), section("wide")];
  put(place, h("h1", { class: "hidden" }, "Controller"),
    h("div", { class: "controller-page" }, top, h("section", { class: "wide" }, h("h2", {}, "Motors"), table), home, pendant, compared));
  const leaveHoming = homing(home, app);
  const lookAtFiles = ending(pendant, app);
  const compare = settings(compared, app);
  const { refresh, hear } = readiness(top, app, compare);
  const showMotors = motorTable(table, true);

  async function ask() {
    let told;
    try {
      told = await order("health");
    } catch {
      return;
    }
    showMotors(told.motors);
    hear(told);
  }

  app.robot.addEventListener("display", refresh);
  app.robot.addEventListener("found", lookAtFiles);
  const asking = setInterval(() => !document.hidden && ask(), EACH);
  const looking = setInterval(() => !document.hidden && lookAtFiles(), LOOKED_EACH);
  refresh();
  ask();
  lookAtFiles();
  return () => {
    clearInterval(asking);
    clearInterval(looking);
    leaveHoming();
    app.robot.removeEventListener("display", refresh);
    app.robot.removeEventListener("found", lookAtFiles);
  };
}

function styled() {
  if (document.querySelector("link[href='/system/controller.css']")) return;
  document.head.append(h("link", { rel: "stylesheet", href: "/system/controller.css" }));
}
