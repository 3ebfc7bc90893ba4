// The page of tools and frames: their poses and the files that declare them, the choice of frames for jogging and
// display, and payloads.

import { get } from "/api.js";
import { button, h, mark, put, text } from "/dom.js";
import { choose, chosen, frameSelect, renew } from "/frames.js";
import { inverse, matrix, numbers, times } from "/poses.js";
import { payloads } from "/setup/payload.js";

const EACH = 4000; // time between two requests [ms]: the session's frames may change
const NAMES = ["X", "Y", "Z", "Roll", "Pitch", "Yaw"];
const ORIGINS = { urdf: "the robot's URDF", "robot.toml": "robot.toml", "cell.toml": "cell.toml", session: "session or program" };

export function toolsPage(place, app) {
  style();
  const ending = new AbortController();
  const { signal } = ending;
  const list = h("ul", { class: "frame-list" });
  const pose = h("output", { class: "frame-pose" });
  const from = h("select", { "aria-label": "Poses seen from", onchange: () => refresh() });
  const weighed = payloads(app);
  let frames = [];
  let rows = [];
  let key = "";

  put(place,
    h("h1", { class: "hidden" }, "Tools and frames"),
    h("div", { class: "tools-page" },
      h("section", {},
        h("h2", {}, "For jogging and display"),
        h("div", { class: "frames" }, frameSelect(app, "moving", "Moved", signal), frameSelect(app, "axes", "seen from", signal)),
        pose,
        h("h2", {}, "Frames"),
        h("div", { class: "frames" }, h("label", { class: "select" }, "Poses (mm, deg) seen from", from)),
        list),
      weighed.element));

  async function ask() {
    const told = await get("/api/tools").catch((refused) => {
      text(pose, refused.message);
      return null;
    });
    if (!told || signal.aborted) return;
    frames = told.frames;
    weighed.take(told);
    const now = JSON.stringify(frames.map(({ name, origin, on_flange }) => [name, origin, on_flange]));
    if (now !== key) {
      key = now;
      draw();
    }
    refresh();
  }

  function draw() {
    const wanted = from.value || chosen(app, "axes")?.name || "{B}";
    put(from, frames.map(({ name }) => h("option", { value: name }, name)));
    from.value = frames.some(({ name }) => name === wanted) ? wanted : "{B}";
    rows = frames.map((frame) => {
      const values = NAMES.map((name) => h("span", { class: "number" }, h("span", { class: "soft" }, name), h("output", {})));
      const used = h("span", { class: "mark", hidden: true });
      const which = frame.on_flange ? "moving" : "axes";
      const element = button([h("span", { class: "frame-name" }, h("strong", { class: "filename" }, frame.name), h("span", { class: "soft" }, ORIGINS[frame.origin]), used), h("span", { class: "numbers" }, values)],
        () => choose(app, which, frame.name), { class: "frame-row", title: frame.on_flange ? "Move and show this frame" : "See from this frame" });
      return { frame, which, used, element, values: values.map((one) => one.children[1]) };
    });
    put(list, rows.map(({ element }) => h("li", {}, element)));
  }

  // Return base_from_frame; null while the robot's position is unknown.
  function placed(frame) {
    if (!frame.on_flange) return frame.pose;
    const flange = app.robot.display?.flange;
    return flange ? times(matrix(flange), frame.pose) : null;
  }

  function refresh() {
    const reference = frames.find(({ name }) => name === from.value);
    const base = reference && placed(reference);
    for (const { frame, which, used, element, values } of rows) {
      // the pose of one flange frame in another doesn't depend on the robot's position
      const both = reference?.on_flange && frame.on_flange;
      const at = both ? times(inverse(reference.pose), frame.pose) : base && placed(frame) && times(inverse(base), placed(frame));
      const shown = at ? numbers(at) : null;
      values.forEach((value, number) => text(value, shown ? clean(shown[number]) : "unknown"));
      const is = chosen(app, which)?.name === frame.name;
      used.hidden = !is;
      text(used, which === "moving" ? "moved" : "reference");
      mark(element, "aria-pressed", String(is));
    }
    const [moving, axes] = [chosen(app, "moving"), chosen(app, "axes")];
    const flange = app.robot.display?.flange;
    if (!moving || !axes) return;
    const tool = flange && numbers(times(inverse(axes.pose), times(matrix(flange), moving.pose)));
    text(pose, tool ? `${moving.name} is at ${tool.map((value, number) => `${NAMES[number]} ${clean(value)}`).join(", ")} (mm, deg) of ${axes.name}.` : "The robot's position isn't known yet.");
  }

  app.robot.addEventListener("display", refresh, { signal });
  app.robot.addEventListener("frames", refresh, { signal });
  const asking = setInterval(() => !document.hidden && ask(), EACH);
  renew(app);
  ask();
  app.whenBack(ask);
  return () => {
    ending.abort();
    clearInterval(asking);
    weighed.close();
  };
}

const clean = (value) => (Math.abs(value) < 5e-4 ? 0 : value).toFixed(3);

function style() {
  if (document.querySelector("link[href='/setup/tools.css']")) return;
  document.head.append(h("link", { rel: "stylesheet", href: "/setup/tools.css" }));
}
