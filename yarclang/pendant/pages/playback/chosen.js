// Actions for a command that the user has tapped: begin the program there, or move to the command's end while a button
// is held.

import { order } from "/api.js";
import { button, called, h, put } from "/dom.js";
import { holdable } from "/holding.js";
import { findings } from "/playback/facts.js";
import { nearest } from "/playback/player.js";

// Speed of a motion to a point, as a share of the limits: as slow as the motion to a program's start.
const SHARE = "10%";

export class Chosen {
  constructor(app, player) {
    this.app = app;
    this.player = player;
    this.element = h("div", { class: "detail", hidden: true });
    this.box = h("div", { class: "go" });
    this.said = h("p", { role: "status" });
    this.ending = new AbortController();
    const { signal } = this.ending;
    app.holding.addEventListener("told", (event) => this.hear(event.detail), { signal });
    app.holding.addEventListener("released", () => this.hear({ state: "ended", why: "" }), { signal });
  }

  // Show the tapped command. A motion to another point that rests on its path is ended.
  show(one) {
    this.app.holding.leave();
    this.one = one;
    this.element.hidden = !one;
    put(this.box);
    if (!one) return;
    const { command, goal } = one;
    put(this.element,
      h("strong", {}, command ? `${called(command.title).filter(Boolean).join(", ")}, line ${command.line}` : one.title),
      command && button("From here", () => this.player.load(this.player.file, command.index), { disabled: !command.index }),
      goal ? button(`Way to ${goal.name}`, () => this.plan(one)) : h("p", {}, "Its end is unknown before the run."),
      this.box);
  }

  get text() {
    const { end } = this.one.goal;
    if (!end) return `MOVEJ_AVOID HOME [${SHARE}]`;
    const units = [...new Set((this.app.about?.joints ?? []).map(({ unit }) => unit))].join(",");
    return `MOVEJ_AVOID ${end.map((value) => value.toFixed(6)).join(" ")} [${SHARE}] (${units})`;
  }

  // Plan and prove a motion from the robot's position to a point. The motion runs only while its button is held.
  async plan(one) {
    const { app } = this;
    if (!this.player.may("programmer")) return;
    app.holding.leave();
    put(this.said, "It is planned and proved.");
    put(this.box, this.said);
    const told = await app.tried(() => order("offer", { text: this.text }));
    if (this.one !== one) return;
    const { offer } = told ?? {};
    if (!offer) {
      put(this.said, told ? "No proved motion leads there." : "It couldn't be planned.");
      if (told) this.box.append(findings(told.findings));
      return;
    }
    put(this.said, `Proved: takes ${offer.duration_s.toFixed(1)} s${nearest(offer)}.`);
    this.button = button(`Hold to go to ${one.command ? "its end" : one.goal.name}`, () => {}, { class: "main hold-to-go" });
    holdable(this.button, app.holding, "go", () => ({ go: offer.number }));
    put(this.box, this.button, this.said);
    this.button.scrollIntoView({ block: "nearest" });
  }

  hear({ state, why, help }) {
    if (!this.button?.isConnected) return;
    const told = why ? `${why}${help ? `: ${help}` : ""}.` : "";
    const rests = "The robot is at rest on its path: hold the button again to continue.";
    put(this.said, { moves: "It goes.", reached: "It is there.", ended: told || rests }[state] ?? told);
  }

  close() {
    this.ending.abort();
    this.app.holding.leave();
  }
}
