// The loaded program of the page Run, with its question before a start, its run and its outcome.

import { order } from "/api.js";
import { button } from "/dom.js";

// Code of the denial if the coordinator doesn't know a program.
const UNKNOWN = "Y1613";
const EVENTS = ["part", "paused", "began", "finished", "wait_began", "wait_ended"];

export class Player extends EventTarget {
  // Return the player of this login. It exists independently of pages, so a loaded program is kept while other pages
  // are shown.
  static of(app) {
    if (app.player?.robot !== app.robot) app.player = new Player(app);
    return app.player;
  }

  constructor(app) {
    super();
    this.app = app;
    this.robot = app.robot;
    this.asked = 0;
    this.close();
    for (const kind of EVENTS) this.robot.addEventListener(kind, (event) => this.hear(event.detail));
    this.robot.addEventListener("lost", () => (this.doubtful = true));
    this.robot.addEventListener("display", ({ detail }) => this.look(detail));
  }

  // After a lost connection, load the program again and withdraw a question: a new coordinator knows neither the loaded
  // program nor the offer that the question is about.
  look(display) {
    if (!display.connected) this.doubtful = true;
    else if (this.doubtful && display.mode === "idle") {
      this.doubtful = false;
      if (this.ask) {
        this.ask = null;
        this.tell();
      }
      this.renew();
    }
  }

  // Load the program again if its file has changed since it was proved, for example by teaching. Do nothing while the
  // robot is executing something.
  async renew() {
    const { program, asked } = this;
    const idle = () => this.robot.display?.mode === "idle";
    if (!program || !idle() || !this.app.may("operator")) return;
    const now = await order("course", { program: program.number, samples: 2 }).catch((refused) => (refused.code === UNKNOWN ? { changed: true } : null));
    if (!now?.changed || asked !== this.asked || !idle() || this.ask) return;
    this.ended = null;
    await this.load(this.file, null, this.bySteps);
  }

  close() {
    this.asked += 1;
    Object.assign(this, { file: "", first: null, bySteps: false, loading: false, told: null, program: null, course: null, way: null, ended: null });
    Object.assign(this, { part: null, paused: null, waits: "", ask: null });
    this.tell();
  }

  tell() {
    this.dispatchEvent(new Event("changed"));
  }

  // Plan and prove a program, optionally from a command on or in steps. Return true if it can be run.
  async load(file, first = null, bySteps = false) {
    const mine = ++this.asked;
    const other = file !== this.file;
    Object.assign(this, { file, first, bySteps, loading: true, told: null, program: null, course: null, way: null, ask: null });
    if (other) Object.assign(this, { ended: null });
    this.tell();
    const fields = { file, approach: true, by_steps: bySteps, ...(first ? { first } : {}) };
    const told = await this.app.tried(() => order("load", fields));
    const program = told?.program ?? null;
    const course = program && (await this.app.tried(() => order("course", { program: program.number })));
    // no reply: the motion to the start isn't known while the robot is moving
    const way = program && first ? await order("way", { program: program.number }).catch(() => null) : null;
    if (mine !== this.asked) return false;
    Object.assign(this, { loading: false, told, program, course, way, at: new Date() });
    this.tell();
    return Boolean(program);
  }

  // Return true if the user has the role and controls the robot; otherwise notify the user.
  may(role = "operator") {
    const { app } = this;
    if (!app.may(role)) {
      app.notice(`This needs the role ${role}; you are ${app.me.role}.`, true);
      return false;
    }
    if (app.controls) return true;
    const asked = app.notice("You don't control the robot.", true, button("Take control", () => (asked.remove(), app.control())));
    return false;
  }

  // Run the loaded program: `times` passes (null: until somebody stops it), or command by command.
  async run(times, bySteps = false) {
    if (!this.may() || !this.file) return;
    if (bySteps !== this.bySteps && !(await this.load(this.file, this.first, bySteps))) return;
    if (!this.program) return;
    const { number } = this.program;
    // check whether the file still has the text that was proved
    const now = await this.app.tried(() => order("course", { program: number, samples: 2 }));
    if (!now) return;
    if (this.course) this.course.changed = now.changed;
    const way = await this.app.tried(() => order("way", { program: number }));
    if (!way) return;
    this.way = way;
    const fields = { program: number, times };
    if (way.findings.some((one) => one.severity === "error") || (way.text && way.duration_s === null)) {
      const away = this.app.may("programmer") ? { label: "Nearest place", act: () => this.recover() } : {};
      this.ask = { text: `The robot can't reach the start: ${way.text}.`, findings: way.findings, ...away };
    } else if (way.text || this.course?.changed) {
      const changed = this.course?.changed ? "The file has changed since the proof: the proved version will run. " : "";
      const text = way.text ? `The robot isn't at the start: ${way.text}. A slow, proved motion leads there in ${way.duration_s.toFixed(1)} s.` : "";
      const label = way.text ? "Move there, then run" : "Run the proved version";
      this.ask = { text: changed + text, label, act: () => this.carry("run", { ...fields, approach: Boolean(way.text) }), reload: this.course?.changed };
    } else {
      this.carry("run", fields);
      return;
    }
    this.tell();
  }

  async carry(word, fields) {
    Object.assign(this, { ask: null, ended: null, paused: null, part: null });
    this.tell();
    const ended = await this.app.tried(() => order(word, fields));
    if (!ended) return;
    this.ended = { ...ended, word };
    Object.assign(this, { part: null, paused: null, waits: "" });
    this.tell();
  }

  // Offer a motion from the robot's position to the program's start, or to the nearest place at which the program may
  // begin. The program itself isn't run.
  async recover() {
    if (!this.may("programmer") || !this.file) return;
    const told = await this.app.tried(() => order("load", { file: this.file, recover: true, ...(this.first ? { first: this.first } : {}) }));
    const number = told?.program?.number;
    const way = number === undefined ? null : await this.app.tried(() => order("offer-recovery", { program: number }));
    if (!way) {
      if (told && !told.program) this.ask = { text: "The program has errors.", findings: told.findings };
    } else if (way.place === null) {
      this.ask = { text: "No proved motion leads from the robot's position to the program.", findings: way.findings };
    } else if (!way.offer) {
      this.ask = { text: `The robot is at ${way.title} already.`, findings: [] };
    } else {
      const assumed = way.assumed.length ? ` The place of ${way.assumed.join(", ")} is unknown: assumed as in the program.` : "";
      const share = Math.round(1000 * way.share) / 10;
      const text = `To ${way.title}: proved, takes ${way.offer.duration_s.toFixed(1)} s at ${share} % of the joints' limits${nearest(way.offer)}.${assumed}`;
      this.ask = { text, findings: way.refused, label: "Go there", act: () => this.carry("go", { offer: way.offer.number }) };
    }
    this.tell();
  }

  // Offer the last motion back along its path.
  async backwards() {
    if (!this.may("programmer")) return;
    const told = await this.app.tried(() => order("offer-back"));
    if (!told) return;
    const { offer } = told;
    if (!offer) this.ask = { text: "There is no motion to reverse.", findings: told.findings };
    else this.ask = { text: `${offer.title}, along its path: proved, takes ${offer.duration_s.toFixed(1)} s${nearest(offer)}.`, label: "Go back", act: () => this.carry("go", { offer: offer.number }) };
    this.tell();
  }

  // Return true if this program itself is being executed, and not the motion to its start.
  runs(display) {
    return display.under_way !== "" && display.under_way === this.program?.name && !this.part?.to_the_start && display.done_s > 0;
  }

  hear(told) {
    if (told.event === "part") Object.assign(this, { part: told, paused: null });
    else if (told.event === "paused") this.paused = told;
    else if (told.event === "wait_began") this.waits = `waits for ${told.name || told.variable}`;
    else if (told.event === "wait_ended") this.waits = "";
    else Object.assign(this, { part: null, paused: null, waits: "" });
  }
}

// Return the smallest clearance of an offer's motions, in words.
export function nearest(offer) {
  const known = offer.motions.map((one) => one.clearance).filter((one) => one?.first);
  const [one] = known.sort((a, b) => a.distance_mm - b.distance_mm);
  return one ? `, ${one.first} stays ${one.distance_mm.toFixed(1)} mm from ${one.second}` : "";
}
