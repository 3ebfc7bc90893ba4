// Texts about a program before its start, and about the end of a run.

import { button, called, h, seconds, stands } from "/dom.js";

export function findings(found) {
  return h("ul", { class: "findings" }, found.map((one) =>
    h("li", { class: one.severity }, h("strong", {}, `${one.code} `), one.message, one.line ? ` (line ${one.line})` : "", one.help ? h("span", { class: "help" }, ` ${one.help}`) : null)));
}

function lasting(takes) {
  const varies = takes.duration_s - takes.duration_at_least_s > 5e-4;
  const known = varies ? `${seconds(takes.duration_at_least_s)} to ${seconds(takes.duration_s)}` : seconds(takes.duration_s);
  const count = takes.waits === takes.waits_at_least ? `${takes.waits}` : `${takes.waits_at_least} to ${takes.waits}`;
  const once = takes.loops ? ", each loop once" : "";
  return `${known}${takes.waits ? `, and ${count} wait${takes.waits > 1 ? "s" : ""}` : ""}${once}`;
}

// Show the results of the proof.
export function facts(app, player, show) {
  const { told, program, course, first, way } = player;
  if (player.loading || !player.file) return [];
  if (!told) return h("p", { class: "bad" }, "It couldn't be loaded.");
  if (!program) return [h("p", { class: "bad" }, "It can't be run."), findings(told.findings)];
  const from = first ? ` from ${stands(first)} on` : "";
  const steps = program.steps ? `, in ${program.steps} steps` : "";
  return [
    h("p", {}, `Proved: takes ${lasting(program.rest_takes)}${from}${steps}.`),
    first && h("p", {}, wayText(way), " ", button("From the beginning", () => player.load(player.file))),
    course && proved(course, show),
    course && version(player, course),
    program.not_looped && h("p", { class: "soft" }, `It can't be run in a loop: ${program.not_looped}.`),
    findings(told.findings),
  ].filter(Boolean);
}

// Show the question before a start, if there is one.
export function question(player) {
  const { ask } = player;
  if (!ask) return [];
  const buttons = [
    ask.act && button(ask.label, ask.act, { class: "main" }),
    ask.reload && button("Load it again", () => player.load(player.file, player.first, player.bySteps)),
    button(ask.act ? "Cancel" : "Close", () => ((player.ask = null), player.tell())),
  ];
  const box = h("div", { class: "ask", role: "alertdialog", "aria-label": "Before the start" }, h("p", {}, ask.text), ask.findings && findings(ask.findings), h("div", { class: "answers" }, ...buttons));
  queueMicrotask(() => box.querySelector("button")?.focus());
  return box;
}

function wayText(way) {
  if (!way) return "The motion there is planned at the start.";
  if (!way.text) return "The robot is there already.";
  return way.duration_s === null ? `No motion leads there: ${way.text}.` : `A proved motion leads there in ${seconds(way.duration_s)}: ${way.text}.`;
}

function proved(course, show) {
  const { nearest, path, peaks } = course;
  const rows = [];
  if (nearest) {
    const distance = `${nearest.distance_mm.toFixed(1)} mm`;
    const text = nearest.first ? `${distance}: ${nearest.first} and ${nearest.second}, in ${called(nearest.title)[0]}, line ${nearest.line}` : `all bodies stay more than ${distance} apart`;
    const time = nearest.at_s ?? course.commands.find(({ title, line }) => title === nearest.title && line === nearest.line)?.begins_s;
    const seen = nearest.at_s === null ? text : `${text}, at ${nearest.at_s.toFixed(1)} s`;
    rows.push(["Smallest clearance", nearest.first && time !== undefined ? button(seen, () => show(time, [nearest.first, nearest.second]), { class: "where" }) : text]);
  }
  rows.push(["Path", `within ${up(path.position_mm)} mm, ${up(path.angle_deg)} deg`]);
  if (peaks) {
    const told = [["velocity", peaks.velocity], ["acceleration", peaks.acceleration], ["jerk", peaks.jerk], ["motor", peaks.motor_velocity]];
    rows.push(["Of the limits", told.filter(([, one]) => one).map(([word, one]) => `${word} ${Math.round(one.share * 100)} % (${one.name})`).join(", ")]);
  }
  if (course.left_out) rows.push(["Ways", `the longest is shown; ${course.left_out} motion${course.left_out > 1 ? "s" : ""} of shorter ones aren't`]);
  if (course.unknown) rows.push(["Motion", `not shown: ${course.unknown}`]);
  return h("dl", { class: "proved" }, rows.flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
}

// Round a proved upper bound up.
const up = (value) => (Math.ceil(value * 1e4 - 1e-9) / 1e4).toFixed(4);

function version(player, course) {
  const proof = `Version ${course.sha256.slice(0, 8) || "unknown"}, proved at ${player.at.toLocaleTimeString()}.`;
  if (!course.changed) return h("p", { class: "soft" }, proof);
  return h("p", { class: "bad" }, `${proof} The file has changed since: the proved version will run. `, button("Load it again", () => player.load(player.file, player.first, player.bySteps)));
}

// Show the reason for the end of a run, its remedy, and the ways to continue.
export function ended(app, player) {
  const { ended: end } = player;
  if (!end) return [];
  if (end.well) return h("p", { class: "good" }, `${end.word === "run" ? player.file : "The motion"} is done${end.passes > 1 ? `, ${end.passes} times` : ""}.`);
  const place = end.where?.line ? ` (line ${end.where.line}${end.where.text ? `: ${end.where.text.trim()}` : ""})` : "";
  const rests = end.resting ? ` It is at rest in ${called(end.resting.title).filter(Boolean).join(", ")}, at ${end.resting.done_s.toFixed(1)} s.` : "";
  return h("div", { class: "end" },
    h("p", {}, h("strong", {}, `${end.word === "run" ? player.file : "The motion"} has ended: `), `${end.what ?? ""}${place}.${rests}`, end.passes > 1 ? ` It was pass ${end.passes}.` : ""),
    end.help && h("p", { class: "help" }, end.help),
    end.word === "run" && end.go_on !== null && end.go_on !== undefined && button(`Continue from ${end.go_on ? stands(end.go_on) : "the beginning"}`, () => player.load(player.file, end.go_on || null)));
}
