// The frames of jogging and display: which one is moved and looked at, and in which other one. One choice for all pages, kept for each user.

import { get } from "/api.js";
import { h, mark, put } from "/dom.js";

const LISTS = { moving: "moving", axes: "fixed" };

const listed = (about, which) => about?.[LISTS[which]] ?? [];

// The frame {name, pose} that is chosen: `which` is "moving" (on the flange) or "axes" (one that stands still).
export function chosen(app, which) {
  const all = listed(app.about, which);
  return all.find(({ name }) => name === app.jog[which]) ?? all[0];
}

// Choose another one. What is held is let go: it would move otherwise than before.
export function choose(app, which, name) {
  if (app.jog[which] === name) return;
  app.holding.releaseAll();
  app.jog[which] = name;
  keep(app);
}

function keep(app) {
  app.remember("jog", app.jog);
  app.robot.dispatchEvent(new Event("frames"));
}

// A choice that there isn't any more falls back to {TCP} or {B}, with a word.
export function settle(app) {
  for (const which of Object.keys(LISTS)) {
    const all = listed(app.about, which);
    const before = app.jog[which];
    if (!all.length || all.some(({ name }) => name === before)) continue;
    app.holding.releaseAll();
    app.jog[which] = all[0].name;
    keep(app);
    app.notice(`There is no frame ${before} any more: ${all[0].name} is ${which === "moving" ? "moved and shown" : "the reference"} from now on.`, true);
  }
}

// Ask whether there are other frames now: another program or cell has its own.
export async function renew(app) {
  const before = app.about;
  const about = await get("/api/robot").catch(() => null);
  if (!about || !app.me || app.about !== before) return;
  const frames = (one) => JSON.stringify([one?.fixed, one?.moving]);
  const other = frames(about) !== frames(app.about);
  app.about = about;
  if (!other) return;
  app.robot.dispatchEvent(new Event("frames"));
  settle(app);
}

// A select that shows the choice and changes it, as long as `signal` isn't aborted.
export function frameSelect(app, which, label, signal) {
  const made = h("select", { onchange: () => choose(app, which, made.value) });
  const draw = () => {
    put(made, listed(app.about, which).map(({ name }) => h("option", { value: name }, name)));
    made.value = chosen(app, which)?.name ?? "";
    mark(made, "data-frames", which);
  };
  app.robot.addEventListener("frames", draw, { signal });
  draw();
  return h("label", { class: "select" }, label, made);
}
