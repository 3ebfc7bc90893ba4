// The buttons at the bottom of the page: run, step, back, hold, resume, override.

import { order } from "/api.js";
import { button, called, h, seconds, text } from "/dom.js";

export class Controls {
  constructor(app, player) {
    this.app = app;
    this.player = player;
    const plain = (word, fields) => app.tried(() => order(word, fields));
    this.run = button("Run", () => player.run(this.times), { class: "main" });
    this.passes = h("select", { "aria-label": "Passes" },
      [1, 2, 5, 10, 50].map((count) => h("option", { value: count }, `${count} ×`)), h("option", { value: "" }, "loop"));
    this.step = button("Step", () => (app.robot.display?.paused ? player.may() && plain("step") : player.run(1, true)));
    this.back = button("Backwards", () => player.backwards());
    this.hold = button("Hold", () => plain("hold"));
    this.answer = h("input", { type: "number", step: 1, hidden: true, "aria-label": "Answer" });
    this.resume = button("Resume", () => player.may() && plain("resume", this.answer.hidden ? {} : { value: this.answer.valueAsNumber }));
    this.pace = h("input", { type: "range", min: 1, max: 100, value: 100, "aria-label": "Override, percent", onchange: () => (player.may() ? plain("override", { percent: Number(this.pace.value) }) : this.refresh(app.robot.display)) });
    this.percent = h("output", {});
    this.told = h("p", { class: "doing", role: "status" });
    this.element = h("div", { class: "controls" },
      h("div", { class: "actions" }, this.run, this.passes, this.step, this.back, this.hold, this.answer, this.resume),
      h("label", { class: "pace" }, h("span", {}, "Override"), this.pace, this.percent),
      this.told);
  }

  get times() {
    return this.passes.value === "" ? null : Number(this.passes.value);
  }

  refresh(display) {
    const { player, app } = this;
    const idle = display.mode === "idle";
    const ready = idle && Boolean(player.program);
    this.run.disabled = !ready;
    this.run.title = player.program ? "" : "Choose a program first";
    const loops = player.program && !player.program.not_looped;
    this.passes.disabled = !ready || !loops;
    if (!loops) this.passes.value = "1";
    this.passes.title = player.program?.not_looped ? `It can't be run in a loop: ${player.program.not_looped}` : "";
    this.step.disabled = !(ready || display.paused);
    this.back.disabled = !idle;
    this.hold.disabled = !app.may("operator") || display.mode !== "program" || display.paused;
    this.ask(display.mode === "held" ? display.asks : null);
    this.resume.disabled = (display.mode !== "held" && !display.paused) || (!this.answer.hidden && !this.answer.checkValidity());
    if (document.activeElement !== this.pace) this.pace.value = display.override;
    text(this.percent, `${Math.round(display.override)} %`);
    text(this.told, this.doing(display));
  }

  // Show a field for the number that a HOLD asks for.
  ask(asks) {
    const { answer } = this;
    if (asks && answer.hidden) {
      [answer.min, answer.max, answer.required, answer.value] = [asks.low, asks.high, true, ""];
      answer.placeholder = `${asks.low} to ${asks.high}`;
      answer.title = asks.text || asks.into;
      answer.oninput = () => this.refresh(this.app.robot.display);
    }
    answer.hidden = !asks;
  }

  // Return the present activity in one line.
  doing(display) {
    const { player } = this;
    if (!display.under_way || display.mode === "jog") return player.program ? "" : "Choose a program.";
    if (display.paused && !player.paused) return "Before the next command: press Step to execute it.";
    if (display.paused) return `Before ${called(player.paused.title).filter(Boolean).join(", ")} (${player.paused.number} of ${player.paused.of}): press Step to execute it.`;
    const { part } = player;
    const many = part && (part.of === null || part.of > 1);
    const which = !part ? "" : part.to_the_start ? "To the start. " : many ? `${player.bySteps ? "Step" : "Pass"} ${part.number}${part.of ? ` of ${part.of}` : ""}. ` : "";
    const now = display.command ? `${called(display.command).filter(Boolean).join(", ")}. ` : "";
    const held = display.mode === "held" ? `Held${display.why ? `: ${display.why}` : ""}. ` : "";
    return `${which}${held}${player.waits ? `It ${player.waits}. ` : ""}${now}${seconds(display.left_s)} left.`;
  }
}
