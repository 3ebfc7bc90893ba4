// The frame around all pages: the robot's state, its owner, the newest alarm, and the STOP button.

import { post } from "/api.js";
import { button, called, h, mark, put, seconds, text } from "/dom.js";

const WORDS = {
  idle: "Idle",
  program: "Running",
  jog: "Jogging",
  held: "Held",
  fault: "Fault",
  disconnected: "Disconnected",
};

// Return what the robot does while the connection is lost, as a sentence derived from its last known state.
function meanwhile(display) {
  if (!display) return "The robot's state is unknown.";
  if (display.mode === "jog") return "A jog ends automatically: the robot comes to rest on its path.";
  if (display.mode === "program") return `The robot continues ${display.under_way}.`;
  if (display.mode === "held") return "The robot was held, and is at rest.";
  return "The robot was at rest.";
}

export class Shell {
  constructor(app) {
    this.app = app;
    const span = (name) => h("span", { class: name });
    this.name = span("name");
    this.state = span("state");
    this.owner = span("owner");
    this.control = button("Take control", () => app.control(), { class: "control" });
    this.give = button("Release control", () => this.release(), { class: "control quiet" });
    this.command = span("command");
    this.times = span("times");
    this.progress = h("progress", { max: 1, "aria-label": "Done" });
    this.override = span("chip");
    this.enabled = span("chip");
    this.homed = span("chip");
    this.guard = span("chip");
    this.alarmCode = span("code");
    this.alarmText = span("alarm-text");
    this.alarm = h("button", { type: "button", class: "alarm", hidden: true, onclick: () => this.openAlarm() }, this.alarmCode, this.alarmText);
    put(
      document.getElementById("bar"),
      h("div", { class: "who" }, this.name, this.state, this.owner, this.control, this.give),
      h("div", { class: "what" }, this.command, this.times, this.progress),
      h("div", { class: "chips" }, this.override, this.enabled, this.homed, this.guard),
      h("div", { class: "alarms", role: "alert" }, this.alarm),
    );
    this.stop = document.getElementById("stop");
    this.lost = document.getElementById("lost");
    this.ending = new AbortController();
    const { signal } = this.ending;
    this.stop.addEventListener("pointerdown", () => this.stopNow(), { signal });
    this.stop.addEventListener("click", (event) => event.detail === 0 && this.stopNow(), { signal });
    window.addEventListener("keydown", (event) => event.key === "Escape" && !event.repeat && this.stopNow(), { signal });
    const robot = app.robot;
    robot.addEventListener("display", () => this.refresh());
    robot.addEventListener("lost", () => this.grey());
    robot.addEventListener("found", () => this.found());
    robot.addEventListener("notice", (event) => this.hear(event.detail));
    robot.addEventListener("answer", (event) => event.detail.ok === false && app.notice(event.detail.error, true));
  }

  stopNow() {
    this.app.holding.releaseAll();
    this.app.robot.stop();
    this.stop.classList.add("pressed");
    setTimeout(() => this.stop.classList.remove("pressed"), 300);
  }

  about() {
    text(this.name, this.app.about.name + (this.app.about.simulated ? " (simulated)" : ""));
    this.refresh();
  }

  refresh() {
    const { app } = this;
    const shown = app.robot.display;
    if (!shown) return;
    text(this.state, WORDS[shown.mode] ?? shown.state);
    mark(this.state, "data-mode", shown.mode);
    this.state.title = shown.why;
    text(this.owner, !shown.connected ? "" : app.controls ? "you control it" : shown.owner ? `${shown.owner} controls it` : "nobody controls it");
    mark(this.owner, "data-own", String(app.controls || !shown.owner));
    this.control.hidden = !shown.connected || app.controls || !app.may("operator");
    text(this.control, shown.owner ? "Ask for control" : "Take control");
    this.give.hidden = !shown.connected || !app.controls;
    const running = Boolean(shown.under_way);
    text(this.command, running ? `${shown.under_way}${shown.command ? `: ${called(shown.command)[0]}` : ""}` : "");
    text(this.times, shown.mode === "program" || shown.mode === "held" ? `${seconds(shown.done_s)} done, ${seconds(shown.left_s)} left` : "");
    const all = shown.done_s + shown.left_s;
    this.progress.hidden = !running || shown.mode === "jog" || all <= 0;
    this.progress.value = all > 0 ? shown.done_s / all : 0;
    text(this.override, `${Math.round(shown.override)} %`);
    this.chip(this.enabled, shown.enabled, "enabled", "not enabled");
    this.chip(this.homed, shown.homed, "homed", "not homed");
    this.chip(this.guard, shown.guard, "guard on", "no guard");
    const { alarm } = shown;
    const whole = shown.audit || (shown.connected ? "" : "the coordinator of the robot can't be reached");
    const more = alarm.open > 1 ? ` (and ${alarm.open - 1} more)` : "";
    text(this.alarmCode, whole ? "" : alarm.code);
    // an alarm whose fault is over stays here until somebody acknowledges it
    text(this.alarmText, whole || `${alarm.holds ? "" : "Not acknowledged: "}${alarm.text}${more}`);
    this.alarm.hidden = !whole && !alarm.number;
  }

  // Open the page of the newest alarm. Once acknowledged, an alarm disappears from all screens, unless its fault is
  // still present.
  openAlarm() {
    const { number } = this.app.robot.display.alarm;
    location.hash = number ? `#/history/alarms/${number}` : "#/history/alarms";
  }

  chip(place, value, good, bad) {
    text(place, value === null ? `${good}?` : value ? good : bad);
    mark(place, "data-good", String(value));
  }

  grey() {
    document.body.classList.add("greyed");
    this.lost.hidden = false;
    put(
      this.lost,
      h("strong", {}, "No connection to the pendant's server."),
      h("span", {}, ` ${meanwhile(this.app.robot.display)} STOP may not arrive: use the emergency stop at the robot.`),
    );
  }

  async found() {
    document.body.classList.remove("greyed");
    this.lost.hidden = true;
    if (this.was) this.app.describe();
    this.was = true;
  }

  hear(notice) {
    if (!notice.ask) {
      this.app.notice(notice.text, notice.warning);
      return;
    }
    const answer = (fields) => this.app.tried(() => post("/api/control/give", fields));
    const shown = this.app.notice(
      notice.text,
      true,
      button("Give", () => (answer({ to: notice.ask }), shown.remove())),
      button("Keep", () => (answer({ to: notice.ask, refuse: true }), shown.remove())),
    );
  }

  async release() {
    await this.app.tried(() => post("/api/control/give", { to: "" }));
  }

  close() {
    this.ending.abort();
    document.body.classList.remove("greyed");
    this.lost.hidden = true;
  }
}
