// The result of a calibration: its values, the error that follows from the spread of the touches, and each touch with
// its residual.

import { button, h } from "/dom.js";

export function resultOf(told) {
  if (!told.result.length && !told.findings.length) return null;
  return h("section", { class: "result" }, h("h2", {}, "Result"),
    told.result.map((line) => h("p", {}, line)),
    told.findings.length > 0 && h("ul", { class: "findings" }, told.findings.map((one) => h("li", { class: one.severity }, `${one.code} ${one.message}`, one.help && h("div", { class: "help" }, one.help)))));
}

export function spreadOf(told) {
  if (!told.spread.length && !told.advice) return null;
  const touch = `${told.error_mm.toFixed(2)} mm${told.told ? " (estimated from the touches)" : " (assumed)"}`;
  const assumed = told.kind === "home" ? "95 of 100 calibrations have a smaller error." : `Errors of each touch: ${touch}. 95 of 100 calibrations have a smaller error.`;
  return h("section", { class: "spread" }, h("h2", {}, "Effect of the spread"),
    told.advice && h("p", { class: "why held-back" }, `${told.advice[0].toUpperCase()}${told.advice.slice(1)}.`),
    told.spread.length > 0 && h("dl", { class: "spread-rows" }, told.spread.flatMap((row) => [
      h("dt", {}, row.label),
      h("dd", { class: row.enough ? "good" : "bad" }, `${row.value}${row.enough ? "" : " – not enough"}`)])),
    told.spread.length > 0 && h("p", { class: "hint" }, assumed));
}

export function touchesOf(told, anew, remove) {
  if (!told.touches.length) return null;
  return h("section", { class: "touches" }, h("h2", {}, "Touches"),
    h("ol", {}, told.touches.map((one, at) => h("li", { class: one.worst ? "worst" : null },
      h("span", { class: "touch" },
        h("strong", {}, `${at + 1}${one.label === "touch" ? "" : ` ${one.label}`}`),
        h("span", { class: one.worst ? "residual bad" : "residual" }, one.residual === null ? "no residual yet" : `off by ${one.residual.toFixed(3)} ${told.unit}${one.worst ? ", the worst" : ""}`),
        h("span", { class: "soft" }, one.joints.map((value) => value.toFixed(1)).join("  "))),
      button("Anew", () => anew(at), { class: "anew", "aria-label": `Record touch ${at + 1} again, at the robot's position` }),
      one.can_go && button("Remove", () => remove(at), { "aria-label": `Remove touch ${at + 1}` })))));
}
