// The chosen frames for jogging and display: the frame on the flange that is moved and displayed, and the reference
// frame. All pages share the choice, which is stored for each user.

import { get } from "/api.js";
import { h, mark, put } from "/dom.js";

const LISTS = { moving: "moving", axes: "fixed" };

const listed = (about, which) => about?.[LISTS[which]] ?? [];

// Return the chosen frame {name, pose}. `which` is "moving" (a frame on the flange) or "axes" (a stationary reference
// frame).
export function chosen(app, which) {
  const all = listed(app.about, which);
  return all.find(({ name }) => name === app.jog[which]) ?? all[0];
}

// Choose a frame. A running jog ends, because the same button would now move the robot differently.
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

// Replace a chosen frame that no longer exists by {TCP} or {B}, and notify the user.
export function settle(app) {
  for (const which of Object.keys(LISTS)) {
    const all = listed(app.about, which);
    const before = app.jog[which];
    if (!all.length || all.some(({ name }) => name === before)) continue;
    app.holding.releaseAll();
    app.jog[which] = all[0].name;
    keep(app);
    app.notice(`The frame ${before} no longer exists: ${all[0].name} is ${which === "moving" ? "moved and shown" : "the reference"} from now on.`, true);
  }
}

// Request the frames again: another program or cell may have other frames.
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

// Return a select element for the chosen frame. It follows changes of the choice until `signal` is aborted.
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
