// The list of a program's commands with their times. It marks the executed command, the command at the timeline's time,
// and the tapped command. Only some rows are in the page at a time.

import { button, called, h, mark, put } from "/dom.js";

const SHOWN = 300; // largest number of rows in the page

// `select` is called with the tapped command and the joint positions at its end; with null if it was tapped again.
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

  // Create the rows of the page, from the entry `from` on.
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

  // Return the row of an entry. If the row isn't in the page, show the rows around it.
  function revealed(one) {
    if (one.place < first || one.place >= first + SHOWN) show(one.place - SHOWN / 2);
    return rows[one.place - first].element;
  }

  show(0);
  return {
    element: list,
    // Mark the command at a time of the timeline.
    mark(time) {
      const now = timed.findLast((one) => one.command.begins_s <= time + 1e-6) ?? commands[0] ?? null;
      if (now === at) return;
      at = now;
      if (at && entries.length > SHOWN) revealed(at).scrollIntoView({ block: "nearest" });
      dress();
    },
    // Mark the command that is being executed.
    refresh(title) {
      if (title === running) return;
      running = title;
      const now = titles.get(title);
      if (now) revealed(now).scrollIntoView({ block: "nearest" });
      dress();
    },
  };
}

// Return a command's name, with its place below it.
function titled({ title, command }) {
  const [name, where] = command ? called(title) : [title, ""];
  return h("span", { class: "title" }, name, where && h("small", {}, where));
}
