// The page Run: choose a program, inspect its motion, and execute it: as a whole, in steps or backwards, from any
// command.

import { button, h, put } from "/dom.js";
import { Chosen } from "/playback/chosen.js";
import { Choosing } from "/playback/choosing.js";
import { commandList } from "/playback/commands.js";
import { Controls } from "/playback/controls.js";
import { ended, facts, question } from "/playback/facts.js";
import { Player } from "/playback/player.js";
import { Timeline } from "/playback/timeline.js";

export function runPage(place, app) {
  const page = new RunPage(place, app);
  return () => page.close();
}

class RunPage {
  constructor(place, app) {
    this.app = app;
    this.player = Player.of(app);
    this.rows = this.listed = this.scene = null;
    this.choosing = new Choosing(app, this.player);
    this.detail = new Chosen(app, this.player);
    this.timeline = new Timeline(app, () => this.shows());
    this.controls = new Controls(app, this.player);
    this.draw(place);
    this.ending = new AbortController();
    const { signal } = this.ending;
    app.robot.addEventListener("display", () => this.refresh(), { signal });
    this.player.addEventListener("changed", () => this.changed(), { signal });
    app.whenBack(() => this.choosing.look());
    this.changed();
    this.choosing.look();
    this.player.renew();
    this.picture_();
  }

  draw(place) {
    this.name = h("h2", {});
    this.told = h("div", { "aria-live": "polite" });
    this.commands = h("section", { class: "list" });
    this.chosen = h("section", { class: "chosen" }, this.detail.element, this.told);
    this.picture = h("section", { class: "picture", hidden: true });
    this.stage = h("div", { class: "stage" }, this.commands, this.chosen, this.picture);
    this.asking = h("div", { class: "asking" });
    this.draws = button("3D", () => this.element.classList.toggle("drawn"), { hidden: true });
    this.head = h("div", { class: "head" }, button("Programs", () => this.choose()), this.name, this.draws);
    const middle = h("div", { class: "middle" }, this.choosing.element, this.stage, this.asking);
    this.element = h("div", { class: "playback" }, this.head, middle, this.timeline.element, this.controls.element);
    put(place, h("h1", { class: "hidden" }, "Run"), this.element);
  }

  choose() {
    this.player.close();
    this.choosing.look();
  }

  // Draw everything again after a choice, a load or the end of a run.
  changed() {
    const { app, player, timeline } = this;
    this.choosing.element.hidden = Boolean(player.file);
    this.head.hidden = this.stage.hidden = timeline.element.hidden = !player.file;
    put(this.name, player.file);
    if (!player.program || player.program !== this.listed) {
      this.detail.show(null);
      this.rows = player.program ? commandList(player, (one) => this.tapped(one)) : null;
      this.listed = player.program;
      put(this.commands, this.rows?.element ?? h("p", {}, player.loading ? "It is planned and proved." : ""));
    }
    put(this.asking, question(player));
    put(this.told, ended(app, player), facts(app, player, (time, bodies) => this.showNearest(time, bodies)));
    const other = timeline.take(player.course, player.program);
    this.scene?.showProgram(player.program?.number ?? null);
    if (other) this.showWay();
    this.refresh();
  }

  tapped(one) {
    this.detail.show(one);
    this.element.classList.remove("drawn");
    this.chosen.scrollTop = 0;
    if (one?.command && one.goal) this.timeline.set(one.command.begins_s);
  }

  shows() {
    const { scene, timeline } = this;
    this.rows?.mark(timeline.time);
    scene?.mark([]);
    scene?.ghost(timeline.scrubbed ? timeline.joints : null);
    scene?.showTime(timeline.course ? timeline.time : null);
  }

  // Show the time of the smallest clearance, and highlight its two bodies.
  showNearest(time, bodies) {
    this.timeline.set(time);
    this.scene?.mark(bodies);
    if (this.scene) this.element.classList.add("drawn");
  }

  showWay() {
    const { course } = this.timeline;
    if (course) this.scene?.showWay(course.course);
    else this.scene?.hideWay();
  }

  refresh() {
    const { display } = this.app.robot;
    if (!display) return;
    const runs = this.player.runs(display);
    this.controls.refresh(display);
    this.timeline.follow(display, runs);
    this.rows?.refresh(runs ? display.command : "");
  }

  // Load the three-dimensional view from files of its own. If that fails, everything else works without it.
  async picture_() {
    try {
      const { Scene3D } = await import("/scene/scene.js");
      if (this.ending.signal.aborted) return;
      this.picture.hidden = this.draws.hidden = false;
      this.element.classList.add("pictured");
      this.scene = new Scene3D(this.picture, this.app);
      this.scene.showProgram(this.player.program?.number ?? null);
      this.showWay();
      this.shows();
    } catch {
      this.scene = null;
      this.picture.hidden = this.draws.hidden = true;
      this.element.classList.remove("pictured");
    }
  }

  close() {
    this.ending.abort();
    this.player.ask = null;
    this.detail.close();
    this.scene?.close();
  }
}
