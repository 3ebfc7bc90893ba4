// The commands with their times, some of them at a time: the one that is carried out, the one under the bar, and the one that was tapped.

import { button, called, h, mark, put } from "/dom.js";

const SHOWN = 300; // rows in the page, however many commands there are

// `select` is told what was tapped, null if it was tapped again: the command, and the point that it ends at.
export function commandList(player, select) {
  const { program, course } = player;
  const ends = new Map((course?.commands ?? []).map((one) => [one.title, one]));
  const start = course?.course.joints[0];
  const points = [start && { title: "Start", goal: { name: "the start", end: start } }, { title: "HOME", goal: { name: "HOME" } }];
  const commands = program.commands.map((command) => {
    const known = ends.get(command.title);
    return { title: command.title, command, goal: known && { name: "its end", end: known.end } };
  });
  const entries = [...points.filter(Boolean), ...commands];
  entries.forEach((one, place) => (one.place = place));
  const titles = new Map(commands.map((one) => [one.title, one]));
  const timed = commands.filter((one) => ends.has(one.title));
  const list = h("ol", { class: "commands" });
  const earlier = h("li", {}, button("Earlier commands", () => turn(-1), { class: "command" }));
  const later = h("li", {}, button("Later commands", () => turn(1), { class: "command" }));
  let [first, rows] = [0, []];
  let [chosen, at, running] = [null, null, ""];

  function choose(one) {
    chosen = chosen === one ? null : one;
    dress();
    select(chosen);
  }

  function row(one) {
    const tap = button("", () => choose(one), { class: "command" });
    const { command } = one;
    put(tap, command && h("span", { class: "line" }, `${command.line}`), titled(one), command && h("span", { class: "time" }, `${command.begins_s.toFixed(1)} s`));
    return { one, tap, element: h("li", { "data-title": one.title }, tap) };
  }

  function dress() {
    for (const { one, tap, element } of rows) {
      mark(tap, "aria-pressed", String(one === chosen));
      element.classList.toggle("at", one === at);
      if (one.command && one.title === running) mark(element, "aria-current", "step");
      else element.removeAttribute("aria-current");
    }
  }

  // Make the rows from one on that are in the page.
  function show(from) {
    first = Math.max(0, Math.min(from, entries.length - SHOWN));
    rows = entries.slice(first, first + SHOWN).map(row);
    put(list, first > 0 && earlier, rows.map((one) => one.element), first + SHOWN < entries.length && later);
    dress();
  }

  function turn(by) {
    const edge = by > 0 ? first + SHOWN : first;
    show(first + by * (SHOWN / 2));
    rows[edge - first]?.element.scrollIntoView({ block: by > 0 ? "end" : "start" });
  }

  // The row of an entry, which is in the page from then on.
  function revealed(one) {
    if (one.place < first || one.place >= first + SHOWN) show(one.place - SHOWN / 2);
    return rows[one.place - first].element;
  }

  show(0);
  return {
    element: list,
    // The command at a time of the bar.
    mark(time) {
      const now = timed.findLast((one) => one.command.begins_s <= time + 1e-6) ?? commands[0] ?? null;
      if (now === at) return;
      at = now;
      if (at && entries.length > SHOWN) revealed(at).scrollIntoView({ block: "nearest" });
      dress();
    },
    // The command that is carried out.
    refresh(title) {
      if (title === running) return;
      running = title;
      const now = titles.get(title);
      if (now) revealed(now).scrollIntoView({ block: "nearest" });
      dress();
    },
  };
}

// What a command does, and below it where it stands.
function titled({ title, command }) {
  const [name, where] = command ? called(title) : [title, ""];
  return h("span", { class: "title" }, name, where && h("small", {}, where));
}
