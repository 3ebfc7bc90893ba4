// The robot in three dimensions at its present position, with its cell, the path of a program, and a translucent robot
// that carries the program's parts.

import { Group } from "/bundles/three.js";
import { h, text } from "/dom.js";
import { chosen } from "/frames.js";
import { Bodies } from "/scene/bodies.js";
import { Labels, namesOf } from "/scene/labels.js";
import { describe, placements } from "/scene/load.js";
import { Painter } from "/scene/painter.js";
import { wayOf } from "/scene/way.js";

// Kinds of bodies and frames that are visible at first.
export const FIRST = { robot: true, tool: true, obstacle: true, part: true, zone: true, shape: false, base: true, tools: true, frames: true, others: false, way: true, labels: true, grid: true };

const NEAR = 0.5; // largest distance from joint positions of the course at which their known link poses are used [deg or mm]
const AGAIN = 3000; // time after which a failed request is repeated [ms]

export class Scene3D {
  // `element` receives the view; `app` is the pendant.
  constructor(element, app) {
    Object.assign(this, { element, app, on: { ...FIRST }, links: null, version: "", program: null, time: null, marked: [] });
    style();
    element.classList.add("scene");
    this.words = h("p", { class: "scene-words", role: "status" }, "The picture is being loaded.");
    this.ending = new AbortController();
    try {
      this.painter = new Painter(element, {
        isHeld: () => Boolean(app.holding?.moving),
        before: () => this.eye.ride(this.bodies.groups.at(-1), this.told),
        after: (camera, width, height) => this.on.labels && this.labels.place(camera, width, height),
        say: (what) => this.say(what),
      });
    } catch {
      element.append(this.words);
      text(this.words, "This browser can't draw in three dimensions (WebGL is off or missing). All other pages work.");
      this.failed = true;
      return;
    }
    this.eye = this.painter.eye;
    this.bodies = new Bodies(this.painter.scene);
    this.more = new Group();
    this.painter.scene.add(this.more);
    this.labels = new Labels(element);
    element.append(this.words);
    this.listen();
    this.load();
  }

  listen() {
    const { signal } = this.ending;
    const { robot } = this.app;
    robot.addEventListener("display", () => this.take(robot.display), { signal });
    robot.addEventListener("lost", () => this.light(), { signal });
    robot.addEventListener("found", () => this.light(), { signal });
    robot.addEventListener("frames", () => (this.name(), this.invalidate()), { signal });
  }

  // Request the description, and draw what has changed.
  async load() {
    if (this.loading) {
      this.again = true;
      return;
    }
    this.loading = true;
    const { program } = this;
    try {
      const told = await describe(program);
      if (program === this.program) await this.draw(told);
    } catch (trouble) {
      this.fail(program, trouble);
    } finally {
      this.loading = false;
      if (!this.closed && (this.again || program !== this.program)) {
        this.again = false;
        this.load();
      }
    }
  }

  async draw(told) {
    await this.bodies.draw(told);
    if (this.closed) return;
    const other = told.tool_pose.join() !== this.told?.tool_pose.join();
    this.told = told;
    this.version = told.version;
    await this.painter.take(told);
    this.links = this.lit = null;
    this.bodies.show(this.on);
    this.bodies.at(this.time);
    this.say("");
    if (this.app.robot.display) this.take(this.app.robot.display);
    this.name();
    this.drawGhost();
    if (this.course && (other || !this.way)) this.drawWay();
    this.element.dispatchEvent(new CustomEvent("drawn", { detail: told }));
    this.invalidate();
  }

  // Handle a failed request. If the program no longer exists, show the robot in the session's cell; otherwise try
  // again.
  fail(program, trouble) {
    if (this.closed || program !== this.program) return;
    this.say(`The picture can't be shown: ${trouble.message}`);
    if (program === null) {
      setTimeout(() => !this.closed && this.load(), AGAIN);
      return;
    }
    this.lost = trouble.message;
    this.program = null;
  }

  // Show a loaded program in its own cell, by its number; null: the robot in the session's cell.
  showProgram(number) {
    if (this.failed || this.wantedProgram === number) return;
    this.wantedProgram = this.program = number;
    this.lost = "";
    this.marked = [];
    this.load();
  }

  // Show the parts at a time of the program [s]; null: at its beginning.
  showTime(time) {
    if (this.time === time) return;
    this.time = time;
    if (!this.told) return;
    if (this.bodies.at(time)) this.name();
    this.invalidate();
  }

  // Highlight bodies by their names; on the translucent robot, if that is shown.
  mark(names) {
    if (names.join("\n") === this.marked.join("\n")) return;
    this.marked = names;
    this.light();
  }

  // Show the present state of the robot.
  take(display) {
    if (!display || !this.told || this.closed) return;
    if (this.program === null && display.scene && display.scene !== this.version && !this.loading) {
      this.version = display.scene;
      this.load();
    }
    const { links } = display;
    if (links.length === 7 * this.told.joints.length && !(this.links && links.every((value, number) => value === this.links[number]))) {
      this.links = links;
      this.bodies.moveTo(links);
      this.invalidate();
    }
    this.light();
  }

  get stale() {
    const { robot } = this.app;
    return !robot.connected || !robot.display?.connected || robot.display.mode === "disconnected";
  }

  // Colour bodies that touch or stop the robot, and marked bodies; all grey while the robot's position is unknown.
  light() {
    const { display } = this.app.robot;
    const names = [...(display?.touching ?? []), ...(display?.stopped_by ?? [])];
    const key = JSON.stringify([this.stale, names, this.marked, this.version, Boolean(this.wanted)]);
    if (!this.told || this.closed || key === this.lit) return;
    this.lit = key;
    this.bodies.light(new Set(names), new Set(this.marked), this.stale);
    this.say(this.stale ? "Not connected: the robot may be at another position." : this.lost ? `This is the robot's present cell: ${this.lost}` : "");
    this.name(new Set([...names, ...this.marked]));
    this.invalidate();
  }

  name(lit = new Set([...(this.app.robot.display?.stopped_by ?? []), ...this.marked])) {
    if (!this.told) return;
    const frames = new Set(["moving", "axes"].map((which) => chosen(this.app, which)?.name));
    this.labels.set(namesOf(this.bodies, this.told.tool, lit, frames));
  }

  say(what) {
    text(this.words, what);
    this.words.hidden = what === "";
  }

  // Show or hide kinds of bodies and frames, as listed in FIRST.
  show(on) {
    Object.assign(this.on, on);
    if (this.failed) return;
    this.bodies.show(this.on);
    this.name();
    this.labels.show(this.on.labels);
    this.more.visible = this.on.way;
    this.painter.showFloor(this.on.grid);
    this.invalidate();
  }

  // Show one of VIEWS (eye.js).
  look(view) {
    if (this.told) this.eye.take(view, this.told);
  }

  // Show the path of a course {times, joints}. Afterwards, the poses of the links along it are known.
  async showWay(course) {
    if (this.failed) return;
    this.course = course;
    if (this.told) await this.drawWay();
    else await new Promise((done) => this.element.addEventListener("drawn", done, { once: true }));
  }

  async drawWay() {
    const { course } = this;
    const mine = (this.asking = {});
    const way = course?.joints?.length ? await wayOf(course, this.told).catch(() => null) : null;
    if (this.closed || mine !== this.asking) {
      way?.close();
      return;
    }
    this.way?.close();
    this.way = way;
    if (way) this.more.add(way.line);
    this.invalidate();
  }

  hideWay() {
    this.course = this.asking = null;
    this.way?.close();
    this.way = null;
    this.invalidate();
  }

  // Show a second, translucent robot at joint positions [deg or mm]; null: hide it.
  ghost(joints) {
    this.wanted = joints;
    this.drawGhost();
  }

  async drawGhost() {
    if (this.failed || !this.told) return;
    const joints = this.wanted;
    const known = joints && this.way?.near(joints, NEAR);
    if (!joints || known) {
      this.ghostAt(known || null);
      return;
    }
    if (this.placing) return; // the newest position is requested after this request
    this.placing = true;
    const [found] = await placements([joints]).catch(() => [null]);
    this.placing = false;
    if (this.closed) return;
    if (found && this.wanted) this.ghostAt(found);
    if (this.wanted !== joints) this.drawGhost();
  }

  ghostAt(links) {
    this.bodies.ghost(links);
    this.light();
    this.invalidate();
  }

  invalidate() {
    this.painter?.invalidate();
  }

  // Release all resources.
  close() {
    if (this.closed) return;
    this.closed = true;
    this.ending.abort();
    this.words.remove();
    this.element.classList.remove("scene");
    if (this.failed) return;
    this.way?.close();
    this.bodies.close();
    this.labels.close();
    this.painter.close();
  }
}

// Load the style sheet of these views, unless it is loaded already.
function style() {
  if (document.querySelector("link[href='/scene/scene.css']")) return;
  document.head.append(h("link", { rel: "stylesheet", href: "/scene/scene.css" }));
}
