// A bar over the time of a program. It shows the command, the program line and the joint positions at a time.

import { called, h, put, text } from "/dom.js";

export class Timeline {
  constructor(app, told) {
    this.app = app;
    this.told = told;
    this.course = null;
    this.scrubbed = false;
    this.bar = h("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0, "aria-label": "Time in the program", oninput: () => this.scrub() });
    this.at = h("output", { class: "at" });
    this.joints_ = h("output", { class: "joints" });
    this.element = h("div", { class: "timeline" }, this.bar, this.at, this.joints_);
  }

  // Set the course of a program. Return true if it differs from the previous course.
  take(course, program) {
    const known = course?.course.times.length ? course : null;
    const other = known !== this.course;
    if (!other && known) return false;
    this.course = known;
    this.scrubbed = false;
    this.bar.disabled = !this.course;
    if (!this.course) {
      put(this.at, program ? "Its motion is unknown." : "");
      put(this.joints_);
      return other;
    }
    const { times } = this.course.course;
    this.bar.min = times[0];
    this.bar.max = times[times.length - 1];
    this.bar.value = times[0];
    this.show();
    return true;
  }

  get time() {
    return Number(this.bar.value);
  }

  // The joint positions at the bar's time, interpolated between the two nearest known ones.
  get joints() {
    if (!this.course) return null;
    const { times, joints } = this.course.course;
    const span = times[times.length - 1] - times[0];
    const place = span > 0 ? ((this.time - times[0]) / span) * (times.length - 1) : 0;
    const before = Math.min(Math.floor(place), times.length - 2);
    const share = Math.min(Math.max(place - before, 0), 1);
    return joints[before].map((value, number) => value + share * (joints[before + 1][number] - value));
  }

  get command() {
    return this.course?.commands.find((one) => this.time <= one.ends_s) ?? this.course?.commands.at(-1) ?? null;
  }

  set(time) {
    if (!this.course) return;
    this.bar.value = time;
    this.scrub();
  }

  scrub() {
    this.scrubbed = true;
    this.show();
  }

  // Move the bar along with the running program, unless the user is moving it.
  follow(display, runs) {
    if (!this.course || !runs || document.activeElement === this.bar) return;
    this.scrubbed = false;
    this.bar.value = display.done_s;
    this.show();
  }

  show() {
    const { command } = this;
    text(this.at, `${this.time.toFixed(1)} s${command ? `  ${called(command.title)[0]}, line ${command.line}` : ""}`);
    const named = this.app.about?.joints ?? [];
    text(this.joints_, (this.joints ?? []).map((value, number) => `${named[number]?.name ?? ""} ${value.toFixed(1)}`).join("  "));
    this.told(this.time);
  }
}
