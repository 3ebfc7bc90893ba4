// Replay of a run in three dimensions: a translucent robot follows the recorded positions, in the present cell.

import { button, h, put, text } from "/dom.js";

const SPEEDS = [0.25, 0.5, 1, 2, 5, 10];

export class Replay {
  constructor(place, app, told, at) {
    Object.assign(this, { app, told, at, time: 0, playing: null });
    const { times } = told.way;
    const names = (app.about?.joints ?? []).map((one) => one.name).join();
    this.fits = times.length > 1 && names === told.joints.map((one) => one.name).join();
    this.picture = h("div", { class: "run-picture" });
    this.play_ = button("Play", () => (this.playing === null ? this.play() : this.pause()), { class: "main" });
    this.speed = h("select", { "aria-label": "Speed" }, SPEEDS.map((one) => h("option", { value: one, selected: one === 1 }, `${one} ×`)));
    this.bar = h("input", { type: "range", min: times[0] ?? 0, max: times.at(-1) ?? 1, step: "any", value: 0, "aria-label": "Time in the run", oninput: () => (this.pause(), this.go(Number(this.bar.value))) });
    this.where = h("output", { class: "at" });
    this.joints = h("output", { class: "joints" });
    put(place, this.fits ? this.picture : h("p", {}, times.length > 1 ? `This is a run of ${told.robot}, another robot: it can't be shown here.` : "No positions were recorded."),
      h("div", { class: "replay-bar", hidden: !this.fits }, this.play_, this.speed, this.bar, this.where), this.joints);
    if (this.fits) this.draw();
  }

  async draw() {
    try {
      const { Scene3D } = await import("/scene/scene.js");
      if (this.closed) return;
      this.scene = new Scene3D(this.picture, this.app);
      this.scene.showWay(this.told.way);
      this.show();
    } catch {
      put(this.picture, h("p", {}, "The picture can't be loaded."));
    }
  }

  play() {
    if (this.time >= Number(this.bar.max) - 1e-3) this.time = Number(this.bar.min);
    let before = performance.now();
    const step = (now) => {
      if (this.playing === null) return;
      const next = this.time + ((now - before) / 1000) * Number(this.speed.value);
      before = now;
      this.go(Math.min(next, Number(this.bar.max)));
      if (next >= Number(this.bar.max)) this.pause();
      else this.playing = requestAnimationFrame(step);
    };
    this.playing = requestAnimationFrame(step);
    text(this.play_, "Pause");
  }

  pause() {
    if (this.playing !== null) cancelAnimationFrame(this.playing);
    this.playing = null;
    text(this.play_, "Play");
  }

  go(time) {
    this.set(time);
    this.at(this.time);
  }

  set(time) {
    this.time = Math.max(Number(this.bar.min), Math.min(Number(this.bar.max), time));
    this.show();
  }

  // Show the recorded position that is nearest to the time. The poses of the links were requested for all recorded
  // positions in advance.
  show() {
    const { times, joints } = this.told.way;
    if (document.activeElement !== this.bar || this.playing !== null) this.bar.value = this.time;
    text(this.where, `${this.time.toFixed(2)} s`);
    if (!this.fits) return;
    let [low, high] = [0, times.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= this.time) low = middle;
      else high = middle;
    }
    const row = joints[this.time - times[low] < times[high] - this.time ? low : high];
    text(this.joints, row.map((value, index) => `${this.told.joints[index].name} ${value.toFixed(1)}`).join("  "));
    if (this.picture.isConnected) this.scene?.ghost(row);
  }

  close() {
    this.closed = true;
    this.pause();
    this.scene?.close();
  }
}
