// An alarm: its row in the list, and its details.

import { get } from "/api.js";
import { button, called, h, put } from "/dom.js";
import { both, facts, goToLine, local } from "/history/look.js";
import { matrix, numbers } from "/poses.js";

const POSE = ["X", "Y", "Z", "Roll", "Pitch", "Yaw"];

export function stateOf(one) {
  if (one.holds) return one.acknowledged ? ["holds", "holds, acknowledged"] : ["holds", "holds"];
  return one.acknowledged ? ["done", "acknowledged"] : ["new", "not acknowledged"];
}

export function rowOf(one, chosen, choose) {
  const [kind, words] = stateOf(one);
  return h("button", { type: "button", class: "open", "aria-expanded": String(chosen), onclick: choose },
    h("span", { class: `badge ${kind}` }, words),
    one.code && h("span", { class: "code" }, one.code),
    h("span", { class: "said-what" }, one.what),
    h("span", { class: "soft" }, `${one.count > 1 ? `${one.count} ×  ` : ""}${local(one.last)}`));
}

function stood(one) {
  if (!one.flange) return "";
  return numbers(matrix(one.flange)).map((value, index) => `${POSE[index]} ${value.toFixed(2)}`).join("  ");
}

function heldUntil(one) {
  if (one.holds) return "it still holds";
  return one.ended === one.time ? "" : both(one.ended);
}

// Return the details of an alarm. `act` has the function `acknowledge`.
export function detailsOf(app, one, act) {
  const explained = h("div", { class: "explained" });
  const joints = one.joints.map((joint) => `${joint.name} ${joint.value.toFixed(2)} ${joint.unit}`).join("  ");
  const where = one.file || one.program;
  if (one.code) explain(app, one.code, explained);
  return h("div", { class: "alarm-details" },
    h("p", { class: "what" }, one.what),
    one.remedy && h("p", { class: "remedy" }, h("strong", {}, "What to do: "), one.remedy),
    h("div", { class: "actions" },
      one.acknowledged ? null : button("Acknowledge", () => act.acknowledge(one), { class: "main", disabled: !app.may("operator"), title: app.may("operator") ? null : "This needs the role operator." }),
      one.file && one.line > 0 ? button("Go to the line", () => goToLine(app, one.file, one.line)) : null),
    facts([
      ["Came", both(one.time)],
      ["Came last", one.count > 1 ? `${both(one.last)}, ${one.count} times` : ""],
      ["Held until", heldUntil(one)],
      ["Acknowledged", one.acknowledged ? `by ${one.by}, ${both(one.acknowledged)}` : "by nobody"],
      ["Program", where ? `${where}${one.line ? `, line ${one.line}` : ""}` : "none"],
      ["Command", one.command ? called(one.command).filter(Boolean).join(", ") : ""],
      ["Joints", joints],
      ["Flange in {B} [mm, deg]", stood(one)],
      ["Robot was owned by", one.owner || "nobody"],
    ]),
    explained);
}

// Show the explanation of a finding's code, with its examples.
async function explain(app, code, place) {
  const told = await app.tried(() => get(`/api/findings/${encodeURIComponent(code)}`));
  if (!told) return;
  const example = (title, text, kind) => text && h("figure", { class: `example ${kind}` }, h("figcaption", {}, title), h("pre", {}, text));
  put(place,
    h("h3", {}, `${told.code}: ${told.title}`),
    h("p", {}, told.why),
    h("div", { class: "examples" }, example("Wrong", told.example, "bad"), example("Better", told.better, "good")));
}
