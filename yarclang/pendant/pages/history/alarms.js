// The page History > Alarms: the faults, the robot's state at that time, remedies, and acknowledgements.

import { get, post } from "/api.js";
import { button, h, put, text } from "/dom.js";
import { detailsOf, rowOf } from "/history/alarm.js";
import { style } from "/history/look.js";

const COUNT = 100; // number of alarms that are listed at once
const PAUSE = 500; // shortest time between two requests while alarms arrive [ms]

class AlarmsPage {
  constructor(place, app, number) {
    this.app = app;
    this.chosen = number;
    this.all = number !== null || app.recall("alarms").all === true;
    this.open = [];
    this.past = [];
    this.ending = new AbortController();
    this.list = h("ul", { class: "alarm-list" });
    this.told = h("p", { class: "soft told-of", role: "status" });
    this.trouble = h("p", { class: "held-back why", role: "alert", hidden: true });
    this.every = button("Acknowledge all", () => this.acknowledgeAll(), { hidden: !app.may("operator") });
    this.older = button("Older", () => this.more(), { hidden: true });
    const filter = (all, label) => h("label", {}, h("input", { type: "radio", name: "which", checked: this.all === all, onchange: () => this.show(all) }), h("span", {}, label));
    put(place,
      h("h1", { class: "hidden" }, "Alarms"),
      h("div", { class: "history-head" },
        h("div", { class: "choice", role: "radiogroup", "aria-label": "Which alarms" }, filter(false, "Open"), filter(true, "All")),
        this.told, this.every, h("a", { class: "press", href: "/api/alarms/export", download: "" }, "Export")),
      this.trouble, h("section", { class: "history-list" }, this.list, this.older));
    app.robot.addEventListener("display", () => this.follow(), { signal: this.ending.signal });
    this.begin();
  }

  async begin() {
    await this.look();
    if (this.chosen === null) return;
    // an alarm that is older than the listed ones is requested by its number
    if (![...this.open, ...this.past].some((one) => one.number === this.chosen)) {
      const found = await get(`/api/alarms/${this.chosen}`).catch(() => null);
      if (found) this.single = found;
      else this.app.notice(`Alarm ${this.chosen} is no longer stored.`, true);
      this.draw();
    }
    this.list.querySelector(".open[aria-expanded=true]")?.scrollIntoView({ block: "start" });
  }

  follow() {
    const version = this.app.robot.display?.alarm.version;
    if (version === this.version || this.waiting) return;
    this.waiting = setTimeout(() => {
      this.waiting = null;
      this.look();
    }, PAUSE);
  }

  show(all) {
    this.all = all;
    this.app.remember("alarms", { all });
    this.look();
  }

  async look() {
    const open = await this.app.tried(() => get(`/api/alarms?which=open&count=${COUNT}`));
    const past = open && this.all ? await this.app.tried(() => get(`/api/alarms?which=past&count=${COUNT}`)) : null;
    if (this.closed || !open) return;
    this.version = open.version;
    this.newest = open.alarms[0]?.number ?? null;
    this.open = open.alarms;
    this.past = past?.alarms ?? [];
    Object.assign(this, { moreOpen: open.more, morePast: Boolean(past?.more) });
    this.every.disabled = !open.alarms.some((one) => !one.acknowledged);
    text(this.told, `${open.open} open, ${open.all} kept`);
    text(this.trouble, open.trouble ? `Alarms are kept only in memory: ${open.trouble}.` : "");
    this.trouble.hidden = !open.trouble;
    this.draw();
  }

  async more() {
    const [which, list] = this.moreOpen ? ["open", this.open] : ["past", this.past];
    const told = await this.app.tried(() => get(`/api/alarms?which=${which}&count=${COUNT}&before=${list.at(-1).number}`));
    if (!told || this.closed) return;
    list.push(...told.alarms);
    this[which === "open" ? "moreOpen" : "morePast"] = told.more;
    this.draw();
  }

  draw() {
    const shown = [...this.open, ...(this.all && !this.moreOpen ? this.past : [])];
    const { single } = this;
    if (single && !shown.some((one) => one.number === single.number)) shown.push(single);
    this.older.hidden = !this.moreOpen && !this.morePast;
    const top = this.list.parentElement.scrollTop;
    put(this.list, shown.map((one) => this.item(one)));
    if (!shown.length) put(this.list, h("li", { class: "empty" }, this.all ? "There is no alarm." : "No alarm is open."));
    this.list.parentElement.scrollTop = top;
  }

  item(one) {
    const chosen = one.number === this.chosen;
    const row = rowOf(one, chosen, () => this.choose(one));
    return h("li", { "data-alarm": one.number }, row, chosen && detailsOf(this.app, one, { acknowledge: () => this.acknowledge({ numbers: [one.number] }) }));
  }

  choose(one) {
    this.chosen = this.chosen === one.number ? null : one.number;
    this.draw();
    const row = this.list.querySelector(`[data-alarm="${one.number}"]`);
    row?.firstChild.focus();
    row?.scrollIntoView({ block: "nearest" });
  }

  acknowledgeAll() {
    if (this.newest !== null) this.acknowledge({ up_to: this.newest });
  }

  async acknowledge(what) {
    const told = await this.app.tried(() => post("/api/alarms/acknowledge", what));
    if (told && !this.closed) await this.look();
  }

  close() {
    this.closed = true;
    clearTimeout(this.waiting);
    this.ending.abort();
  }
}

export function alarmsPage(place, app, rest) {
  style();
  const page = new AlarmsPage(place, app, /^\d{1,15}$/.test(rest) ? Number(rest) : null);
  app.whenBack(() => page.look());
  return () => page.close();
}
