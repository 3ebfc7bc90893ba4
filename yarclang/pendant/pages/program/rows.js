// The list of commands. Only the visible rows are in the page, even for a long program.

import { h, mark } from "/dom.js";

const HEIGHT = 46;
const BESIDE = 6; // number of rows above and below the visible ones that are also in the page

export class Rows extends EventTarget {
  constructor() {
    super();
    this.inner = h("div", { class: "rows-inner" });
    this.place = h("div", { class: "rows", role: "listbox", tabindex: 0, "aria-label": "Commands", "aria-multiselectable": "true" }, this.inner);
    this.commands = [];
    this.first = this.last = -1;
    this.marks = new Map();
    this.shown = new Map();
    this.running = 0;
    this.place.addEventListener("scroll", () => this.draw(), { passive: true });
    this.place.addEventListener("keydown", (event) => this.press(event));
    this.place.addEventListener("click", (event) => {
      const row = event.target.closest("[data-row]");
      if (row) this.choose(Number(row.dataset.row), event.shiftKey);
    });
    this.sized = new ResizeObserver(() => this.draw());
    this.sized.observe(this.place);
  }

  set(commands) {
    this.commands = commands;
    this.inner.style.height = `${commands.length * HEIGHT}px`;
    for (const row of this.shown.values()) row.remove();
    this.shown.clear();
    this.last = Math.min(this.last, commands.length - 1);
    this.first = Math.min(this.first, this.last);
    this.draw();
  }

  // Set the worst severity of each line.
  findings(marks) {
    this.marks = marks;
    for (const [index, row] of this.shown) this.dress(row, index);
  }

  run(line) {
    if (line === this.running) return;
    this.running = line;
    for (const [index, row] of this.shown) this.dress(row, index);
    if (line) this.reveal(this.rowOf(line));
  }

  // Return the index of the row with a line; for a line between two commands, that of the row before.
  rowOf(line) {
    let [from, to] = [0, this.commands.length];
    while (from < to) {
      const middle = (from + to) >> 1;
      if (this.commands[middle].line <= line) from = middle + 1;
      else to = middle;
    }
    return from - 1;
  }

  // Mark the rows of the lines that are selected in the text.
  follow(first, last) {
    const [from, to] = [this.rowOf(first), this.rowOf(last)];
    if (from === this.first && to === this.last) return;
    [this.first, this.last] = [from, to];
    this.reveal(from);
    for (const [index, row] of this.shown) this.dress(row, index);
  }

  choose(index, further) {
    if (!this.commands.length) return;
    const to = Math.max(0, Math.min(index, this.commands.length - 1));
    this.anchor = further ? this.anchor ?? this.first : to;
    [this.first, this.last] = [Math.min(this.anchor, to), Math.max(this.anchor, to)];
    this.reveal(to);
    for (const [row, made] of this.shown) this.dress(made, row);
    this.dispatchEvent(new Event("chosen"));
  }

  get selected() {
    return this.first < 0 ? [] : this.commands.slice(this.first, this.last + 1);
  }

  press(event) {
    const page = Math.max(1, Math.floor(this.place.clientHeight / HEIGHT) - 1);
    const steps = { ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -Infinity, End: Infinity };
    const step = steps[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const from = step > 0 ? this.last : this.first;
    this.choose(from + step, event.shiftKey);
  }

  reveal(index) {
    if (index < 0) return;
    const { scrollTop, clientHeight } = this.place;
    const top = index * HEIGHT;
    if (top < scrollTop) this.place.scrollTop = Math.max(0, top - HEIGHT);
    else if (top + HEIGHT > scrollTop + clientHeight) this.place.scrollTop = top + 2 * HEIGHT - clientHeight;
    this.draw();
  }

  draw() {
    const from = Math.max(0, Math.floor(this.place.scrollTop / HEIGHT) - BESIDE);
    const to = Math.min(this.commands.length, Math.ceil((this.place.scrollTop + this.place.clientHeight) / HEIGHT) + BESIDE);
    for (const [index, row] of this.shown) {
      if (index >= from && index < to) continue;
      row.remove();
      this.shown.delete(index);
    }
    for (let index = from; index < to; index++) {
      if (this.shown.has(index)) continue;
      const row = this.made(index);
      this.shown.set(index, row);
      this.inner.append(row);
    }
  }

  made(index) {
    const one = this.commands[index];
    const row = h(
      "div",
      { class: "row", role: "option", id: `row-${index}`, "data-row": index, "data-kind": one.kind, "aria-posinset": index + 1, "aria-setsize": this.commands.length },
      h("span", { class: "index" }, one.index || one.line),
      h("span", { class: "words" }, h("span", { class: "title" }, one.title), one.detail ? h("span", { class: "detail" }, one.detail) : null),
      h("span", { class: "sign", "aria-hidden": "true" }),
    );
    row.style.transform = `translateY(${index * HEIGHT}px)`;
    row.style.paddingLeft = `${8 + 16 * Math.min(one.depth, 8)}px`;
    this.dress(row, index);
    return row;
  }

  dress(row, index) {
    const one = this.commands[index];
    const chosen = index >= this.first && index <= this.last;
    mark(row, "aria-selected", String(chosen));
    if (index === this.last) mark(this.place, "aria-activedescendant", row.id);
    const now = this.running >= one.line && this.running < one.line + one.rows;
    if (now) mark(row, "aria-current", "step");
    else row.removeAttribute("aria-current");
    let worst = "";
    for (let line = one.line; line < one.line + Math.min(one.rows, 50); line++) {
      const found = this.marks.get(line);
      if (found === "error" || (found === "warning" && worst !== "error") || (found && !worst)) worst = found;
    }
    mark(row, "data-found", worst);
    row.title = worst ? `${one.title} (${worst})` : one.title;
  }

  close() {
    this.sized.disconnect();
  }
}
