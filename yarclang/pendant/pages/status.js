// The page Status: joint positions within their limits, the pose of the tool in any frame, motors, connection and
// buffer.

import { order } from "/api.js";
import { h, mark, put, text } from "/dom.js";
import { chosen, frameSelect, renew } from "/frames.js";
import { inverse, matrix, numbers, times } from "/poses.js";
import { motorTable } from "/system/motors.js";

const EACH = 500;
const NAMES = ["X", "Y", "Z", "Roll", "Pitch", "Yaw"];

export function statusPage(place, app) {
  const bars = h("div", { class: "bars" });
  const pose = h("table", { class: "pose" });
  const motors = h("table", { class: "motors" });
  const link = h("dl", { class: "link" });
  const joints = (app.about?.joints ?? []).map((joint) => {
    const bar = h("div", { class: "bar", role: "meter", "aria-label": joint.name, "aria-valuemin": joint.lower, "aria-valuemax": joint.upper }, h("span", { class: "at" }));
    const value = h("output", {});
    return { joint, bar, value, row: h("div", { class: "joint" }, h("strong", {}, joint.name), h("span", { class: "limit" }, joint.lower.toFixed(0)), bar, h("span", { class: "limit" }, joint.upper.toFixed(0)), value) };
  });
  put(bars, joints.map(({ row }) => row));
  const ending = new AbortController();
  const moving = frameSelect(app, "moving", "Frame", ending.signal);
  const fixed = frameSelect(app, "axes", "in", ending.signal);
  const cells = NAMES.map((name, number) => {
    const value = h("td", {});
    return { value, row: h("tr", {}, h("th", { scope: "row" }, name), value, h("td", {}, number < 3 ? "mm" : "deg")) };
  });
  put(pose, h("tbody", {}, cells.map(({ row }) => row)));
  put(place,
    h("h1", { class: "hidden" }, "Status"),
    h("div", { class: "columns stacked" },
      h("section", {}, h("h2", {}, "Joints"), bars, h("h2", {}, "Pose"), h("div", { class: "frames" }, moving, fixed), pose),
      h("section", {}, h("h2", {}, "Motors"), motors, h("h2", {}, "Link and buffer"), link,
        h("a", { class: "place", href: "#/system/controller" }, "Controller: enable, home, clear a fault"))));

  function refresh() {
    const display = app.robot.display;
    if (!display || !app.about) return;
    joints.forEach(({ joint, bar, value }, number) => {
      const at = display.joints[number];
      text(value, at === null ? "unknown" : `${at.toFixed(3)} ${joint.unit}`);
      if (at === null) return;
      const share = (at - joint.lower) / (joint.upper - joint.lower);
      bar.firstChild.style.setProperty("left", `${Math.max(0, Math.min(1, share)) * 100}%`);
      mark(bar, "aria-valuenow", at.toFixed(3));
      mark(bar, "data-near", String(share < 0.05 || share > 0.95));
    });
    if (display.flange) {
      const tool = times(matrix(display.flange), chosen(app, "moving").pose);
      numbers(times(inverse(chosen(app, "axes").pose), tool)).forEach((one, number) => text(cells[number].value, one.toFixed(3)));
    }
  }

  const showMotors = motorTable(motors);
  async function ask() {
    let told;
    try {
      told = await order("health");
    } catch {
      return;
    }
    showMotors(told.motors);
    const facts = {
      "Last reply": `${(told.reply_s * 1e3).toFixed(1)} ms`,
      "Slowest reply": `${(told.slowest_s * 1e3).toFixed(1)} ms`,
      "Lines ahead in the buffer": told.ahead === null ? "nothing is streamed" : String(told.ahead),
      "Allowed silence of this computer": `${told.silence_s.toFixed(2)} s`,
      "Guard PLC": told.guard ? "tried, works" : "not known",
    };
    put(link, Object.entries(facts).flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
  }

  app.robot.addEventListener("display", refresh);
  const asking = setInterval(() => !document.hidden && ask(), EACH);
  app.robot.addEventListener("frames", refresh, { signal: ending.signal });
  refresh();
  renew(app);
  ask();
  return () => {
    clearInterval(asking);
    ending.abort();
    app.robot.removeEventListener("display", refresh);
  };
}
