// Joint torques as bars, without and with a payload, relative to the largest torques of the motors.

import { button, h, put } from "/dom.js";

const WORDS = {
  here: ["Here", "At rest, at the robot's position."],
  reach: ["Worst pose", "At rest, the largest within the joint limits, even if the robot can't reach that position."],
  program: ["Program", "The largest during the program, on all of its branches."],
};

// Show the server's message about a payload. `write` opens the change of the file.
export function drawTorques(place, told, write, mayWrite) {
  const bars = h("div", { class: "torque-bars" });
  const kinds = told.torques.map(({ what }) => what);
  let kind = kinds.includes("program") ? "program" : kinds[0];
  const tabs = kinds.map((what) => button(WORDS[what][0], () => { kind = what; draw(); }, { "data-what": what }));

  function draw() {
    for (const tab of tabs) tab.setAttribute("aria-pressed", String(tab.dataset.what === kind));
    const one = told.torques.find(({ what }) => what === kind);
    put(bars, one ? content(told.joints, one) : h("p", {}, `The torques are unknown: ${told.unknown}.`));
  }

  const errors = told.findings.filter(({ severity }) => severity === "error" || severity === "warning");
  put(place,
    errors.length > 0 && h("ul", { class: "findings" }, errors.map((one) => h("li", { class: one.severity }, one.message, one.help && h("div", { class: "help" }, one.help)))),
    h("div", { class: "actions torque-kinds" }, tabs),
    bars,
    h("div", { class: "actions" }, button("Show the change of robot.toml", write, { class: "main", disabled: !told.sound })),
    !mayWrite && h("p", { class: "said" }, "Writing it needs the role service."));
  draw();
}

function content(joints, one) {
  const most = Math.max(1e-9, ...one.now.map(Math.abs), ...one.then.map(Math.abs));
  const used = joints.map(({ effort }, at) => (effort === null ? 0 : Math.abs(one.then[at]) / effort));
  const worst = used.indexOf(Math.max(...used));
  const where = one.where[worst] ? ` in ${one.where[worst]}` : "";
  const pose = one.at[worst].map((value) => value.toFixed(1)).join(", ");
  return [
    h("p", { class: "said" }, WORDS[one.what][1], " Upper bar: now; lower bar: with the payload. Parts in a gripper aren't included."),
    ...joints.map((joint, at) => row(joint, one.now[at], one.then[at], joint.effort ?? most)),
    used[worst] > 0 && h("p", { class: used[worst] > 1 ? "bad" : "said" }, `${joints[worst].name} uses the most of its limit, ${percent(used[worst])}${where}, with the joints at ${pose}.${used[worst] > 1 ? " This exceeds the limit of its motor." : ""}`),
  ];
}

function row(joint, now, then, full) {
  const over = joint.effort !== null && Math.abs(then) > joint.effort;
  const limit = joint.effort === null ? "limit not known" : `of ${joint.effort} ${joint.unit}, ${percent(Math.abs(then) / joint.effort)}`;
  return h("div", { class: "torque", "data-over": String(over) },
    h("strong", {}, joint.name),
    h("div", { class: "torque-pair", role: "img", "aria-label": `${joint.name}: now ${shown(now)}, with the payload ${shown(then)} ${joint.unit}` }, bar("now", now, full), bar("then", then, full)),
    h("output", {}, `${shown(now)} → ${shown(then)} ${joint.unit}`), h("span", { class: "soft" }, limit));
}

// Use a progress element, which draws itself: the security policy forbids inline styles.
function bar(kind, value, full) {
  return h("progress", { class: kind, max: 1, value: String(Math.min(1, Math.abs(value) / full)) });
}

const shown = (value) => (Math.abs(value) < 0.05 ? 0 : value).toFixed(Math.abs(value) < 100 ? 1 : 0);
const percent = (share) => `${(100 * share).toFixed(share < 0.1 ? 1 : 0)} %`;
