// The page Health: disk, memory, processors, connection and stored data with their thresholds and the last hour, and
// versions for bug reports.

import { get } from "/api.js";
import { button, h, mark, put, text } from "/dom.js";
import { sparkline } from "/system/sparkline.js";
import { count, styled } from "/system/look.js";

const EACH = 2000;
const WORDS = { good: "good", warning: "warning", bad: "bad", unknown: "not known", plain: "" };

export function healthPage(place, app) {
  styled("health");
  const groups = h("div", { class: "health-groups" });
  const running = h("p", { class: "soft running" });
  const versions = h("dl", { class: "versions" });
  const written = h("textarea", { class: "report", readonly: true, rows: 8, "aria-label": "Text for a bug report", hidden: true });
  put(place, h("h1", { class: "hidden" }, "Health"), running, groups,
    h("section", {}, h("h2", {}, "Versions"), versions,
      h("div", { class: "actions" }, button("Copy as text", () => copy()), h("span", { class: "soft" }, "It contains no names of people, computers or folders.")), written));
  let rows = [];
  let report = "";
  let left = false;

  async function ask() {
    let told;
    try {
      told = await get("/api/system/health");
    } catch {
      return;
    }
    if (left) return;
    if (rows.map(({ name }) => name).join() !== told.watched.map(({ name }) => name).join()) build(told.watched);
    told.watched.forEach((one, number) => rows[number].show(one));
    text(running, `Running for ${lasting(told.uptime_s)}; ${count(told.sessions, "session")}, ${count(told.pages, "page")} connected.`);
    if (!report) put(versions, told.versions.flatMap(({ name, version }) => [h("dt", {}, name), h("dd", {}, version)]));
    report = told.text;
  }

  function build(watched) {
    rows = watched.map(row);
    const names = [...new Set(watched.map(({ group }) => group))];
    put(groups, names.map((group) => h("section", {}, h("h2", {}, group), rows.filter((one) => one.group === group).map((one) => one.element))));
  }

  async function copy() {
    try {
      await navigator.clipboard.writeText(report);
      app.notice("Versions and health were copied.");
    } catch {
      written.hidden = false; // without access to the clipboard, the user copies the selected text
      written.value = report;
      written.focus();
      written.select();
    }
  }

  const asking = setInterval(() => !document.hidden && ask(), EACH);
  ask();
  return () => {
    left = true;
    clearInterval(asking);
  };
}

// A row for one monitored number. Opened, it shows why the number matters.
function row(one) {
  const level = h("span", { class: "level" });
  const value = h("span", { class: "value" });
  const line = sparkline(one.name);
  const [why, limits, remedy] = [h("p", {}), h("p", { class: "soft" }), h("p", {})];
  const body = h("div", { class: "health-more" }, why, remedy, limits);
  const head = [level, h("span", { class: "health-name" }, one.name), value, line.element];
  const element = one.why ? h("details", { class: "health-row" }, h("summary", {}, head), body) : h("div", { class: "health-row" }, h("div", { class: "summary" }, head));
  function show(now) {
    text(level, WORDS[now.level]);
    mark(element, "data-level", now.level);
    text(value, now.value);
    text(why, now.why);
    text(limits, `Thresholds: ${now.limits}.`);
    text(remedy, now.remedy);
    line.show(now.history);
  }
  return { name: one.name, group: one.group, element, show };
}

function lasting(seconds) {
  if (seconds < 120) return `${Math.round(seconds)} s`;
  if (seconds < 7200) return `${Math.round(seconds / 60)} min`;
  return seconds < 172800 ? `${Math.round(seconds / 3600)} h` : `${Math.round(seconds / 86400)} days`;
}
