// The page Jog: motion of joints, or of the tool in any frame, while a button is held.

import { h, put, text } from "/dom.js";
import { chosen, frameSelect, renew } from "/frames.js";
import { holdable } from "/holding.js";
import { inverse, matrix, numbers, times } from "/poses.js";

const STEPS = [
  [0, "hold"],
  [0.1, "0.1"],
  [1, "1"],
  [10, "10"],
];
const LONG = 6; // longest joint name on a button; a longer name stands beside the buttons, which then show J1, J2 and so on
const LETTERS = [..."xyzabc"];
const NAMES = ["X", "Y", "Z", "A (about X)", "B (about Y)", "C (about Z)"];

export function jogPage(place, app) {
  const settings = app.jog;
  const { holding } = app;
  holding.settings = () => ({ ...settings, axes: settings.kind === "tool" ? settings.moving : settings.axes, robot: app.about });
  const rows = h("div", { class: "axes" });
  const why = h("p", { class: "why", role: "status" });
  const speed = h("input", {
    type: "range", min: 1, max: 100, step: 1, value: Math.round(settings.share * 100), "aria-label": "Jog speed, percent",
    oninput: () => { settings.share = Number(speed.value) / 100; keep(); },
  });
  const shown = h("output", {});
  const kinds = choice("What is jogged", [["joint", "Joints"], ["base", "Frame"], ["tool", "Tool"]], settings.kind, (value) => { settings.kind = value; keep(); draw(); });
  const steps = choice("Step (mm, deg)", STEPS.map(([value, label]) => [String(value), label]), String(settings.step), (value) => { settings.step = Number(value); keep(); });
  const frames = h("div", { class: "frames" });
  const side = h("div", { class: "jog-beside", hidden: true });
  const ending = new AbortController();
  const moved = frameSelect(app, "moving", "Moved", ending.signal);
  const along = frameSelect(app, "axes", "Along axes of", ending.signal);
  let values = [];

  const nudge = (by) => { speed.value = Number(speed.value) + by; speed.dispatchEvent(new Event("input")); };
  put(
    place,
    h("h1", { class: "hidden" }, "Jog"),
    h("div", { class: "choices" }, kinds, steps,
      h("div", { class: "speed" },
        h("span", { class: "caption" }, "Speed"),
        h("button", { type: "button", "aria-label": "Slower", onclick: () => nudge(-5) }, "−"), speed,
        h("button", { type: "button", "aria-label": "Faster", onclick: () => nudge(5) }, "+"), shown)),
    h("div", { class: "jog-columns" }, h("div", { class: "jog-main" }, frames, rows, h("div", { class: "why-row" }, why, app.back && h("a", { class: "press", href: app.back.href }, app.back.label))), side),
  );

  function keep() {
    holding.releaseAll();
    app.remember("jog", settings);
    label();
  }

  function label() {
    if (!app.about) return;
    const fast = settings.kind === "joint" ? "" : `, ${(settings.share * app.about.jog_speed_mm_s).toFixed(0)} mm/s`;
    text(shown, `${Math.round(settings.share * 100)} %${fast}`);
  }

  function draw() {
    label();
    if (!app.about) return;
    const joint = settings.kind === "joint";
    const axes = joint ? app.about.joints.map(({ name }) => name) : LETTERS;
    put(frames,
      !joint && moved,
      settings.kind === "base" && along);
    values = axes.map(() => h("output", { class: "value" }));
    put(rows, axes.map((axis, number) => {
      const short = joint && !axes.some((one) => /^J[0-9]+$/i.test(one)) ? `J${number + 1}` : "";
      const name = joint ? `${short} ${axis}`.trim() : NAMES[number];
      const key = (sign) => {
        const made = h("button", { type: "button", class: "jog", "aria-label": `${name} ${sign > 0 ? "plus" : "minus"}`, "data-axis": axis, "data-sign": sign }, `${axis.length > LONG ? short : joint ? axis : axis.toUpperCase()}${sign > 0 ? "+" : "−"}`);
        holdable(made, holding, `${axis}${sign}`, () => (joint ? { joint: axis, sign } : { axis, sign }));
        return made;
      };
      return h("div", { class: "axis" }, key(-1), h("span", { class: "label" }, h("span", {}, name), values[number]), key(1));
    }));
    refresh();
  }

  function refresh() {
    const display = app.robot.display;
    if (!display || !app.about) return;
    if (settings.kind === "joint") {
      app.about.joints.forEach((joint, number) => {
        const value = display.joints[number];
        text(values[number], value === null ? "unknown" : `${value.toFixed(3)} ${joint.unit}`);
      });
    } else if (display.flange) {
      const pose = times(matrix(display.flange), chosen(app, "moving").pose);
      const from = settings.kind === "base" ? chosen(app, "axes") : null;
      numbers(from ? times(inverse(from.pose), pose) : pose).forEach((value, number) =>
        text(values[number], `${value.toFixed(number < 3 ? 2 : 3)} ${number < 3 ? "mm" : "deg"}`));
    }
    if (!holding.moving) idle(display);
  }

  // Return the reason why the robot can't be jogged now; empty: it can.
  function idle(display) {
    let what = "";
    if (!app.may("programmer")) what = "Jogging needs the role programmer.";
    else if (!app.controls) what = "Take control of the robot first.";
    else if (display.mode === "fault") what = "The robot has a fault: see System > Controller.";
    else if (display.mode === "held" && display.under_way === "jog") what = "The robot is stopping.";
    else if (display.mode !== "idle" && display.mode !== "jog") what = `The robot is ${display.mode === "program" ? "running a program" : display.mode}.`;
    else if (display.enabled === false) what = "A motor isn't enabled: see System > Controller.";
    else if (display.homed === false) what = "A motor isn't homed: see System > Controller.";
    rows.classList.toggle("unusable", what !== "");
    if (what) text(why, what);
    else if (!told) text(why, "Hold a button: the robot moves until you release it.");
  }

  let told = "";
  const hear = ({ detail }) => {
    told = detail.why ? detail.why + (detail.help ? `: ${detail.help}` : "") : "";
    why.classList.toggle("held-back", told !== "");
    text(why, detail.state === "reached" ? "Step done." : told || (holding.moving ? "Moving." : ""));
  };
  const begun = () => { told = ""; };
  holding.addEventListener("told", hear);
  holding.addEventListener("begun", begun);
  app.robot.addEventListener("display", refresh);
  app.robot.addEventListener("frames", refresh, { signal: ending.signal });
  draw();
  renew(app);
  let [left, leave] = [false, () => {}];
  if (matchMedia("(min-width: 1100px)").matches) {
    import("/scene/page.js").then(({ beside }) => left || (leave = beside(side, app)), () => {});
  }
  return () => {
    left = true;
    ending.abort();
    leave();
    holding.removeEventListener("told", hear);
    holding.removeEventListener("begun", begun);
    app.robot.removeEventListener("display", refresh);
  };
}

function choice(label, values, chosen, act) {
  const name = `choice-${label.replace(/\W/g, "")}`;
  return h("fieldset", { class: "choice" }, h("legend", {}, label),
    values.map(([value, shown]) =>
      h("label", {}, h("input", { type: "radio", name, value, checked: value === chosen, onchange: () => act(value) }), h("span", {}, shown))));
}
