// Switching of outputs, and of a simulated robot's inputs: rights, questions before a switch, and its result.

import { order } from "/api.js";
import { button, h, text } from "/dom.js";
import { opened } from "/files/asking.js";
import { shownValue } from "/io/row.js";

export class Switching {
  // `done` is called after a value was set.
  constructor(app, done) {
    Object.assign(this, { app, done, fixed: "" });
    this.reasons = { output: h("p", { class: "why" }), input: h("p", { class: "why" }) };
  }

  // Return the reason why no output (or input) can be switched now; empty: they can.
  whyNot(kind) {
    const { app } = this;
    const display = app.robot.display;
    if (!app.may("programmer")) return `Switching ${kind}s needs the role programmer.`;
    if (!app.robot.connected || !display?.connected) return "The robot's coordinator can't be reached.";
    if (kind === "input") return display.owner && !app.controls ? `${display.owner} controls the robot: take control first.` : "";
    if (!app.controls) return "Take control of the robot first.";
    if (display.mode === "idle") return "";
    return display.mode === "fault" || display.mode === "disconnected" ? "The robot has a fault: see Status." : "Outputs can't be switched while a program or motion is running.";
  }

  tell(parts, reasons) {
    for (const [kind, part] of Object.entries(parts)) {
      const shown = this.reasons[kind];
      if (shown.parentElement !== part) part.firstChild.after(shown);
      text(shown, reasons[kind]);
      shown.hidden = reasons[kind] === "";
    }
  }

  async set(row, value) {
    if (row.value === value && !row.heard) return;
    const danger = dangers(row, value);
    if (danger && !(await asked(`Switch ${row.signal.name} to ${shownValue(value)}?`, danger))) return;
    const made = await this.app.tried(() => order(row.signal.kind === "output" ? "set" : "input", { name: row.signal.name, value }));
    if (!made) return;
    if (made.value !== null && row.signal.kind === "output") row.set(made.value);
    this.took(row.signal.name, value, made);
  }

  took(name, value, made) {
    const [finding] = made.findings;
    if (made.value === null) this.app.notice(finding ? `${finding.message} ${finding.help ?? ""}` : `${name} wasn't set.`, true);
    else if (made.value !== value) this.app.notice(`${name} is ${shownValue(made.value)}, not ${shownValue(value)}.`, true);
    this.done();
  }

  // Ask the user for a number, and set it.
  ask(row) {
    this.typed(`A value of ${row.signal.name}`, row.value ?? 0, (value) => this.set(row, value));
  }

  typed(title, first, act) {
    const input = h("input", { type: "number", step: "any", inputmode: "decimal", name: "value", value: String(first), "aria-label": title });
    const told = h("p", { class: "told", role: "alert" });
    const form = h("form", {
      onsubmit: (event) => {
        event.preventDefault();
        const value = input.value.trim() === "" ? NaN : Number(input.value);
        if (!Number.isFinite(value)) {
          text(told, "Enter a number.");
          return;
        }
        dialog.close();
        act(value);
      },
    }, h("h2", {}, title), input, told, h("div", { class: "actions" }, h("button", { type: "submit", class: "main" }, "Set"), button("Cancel", () => dialog.close())));
    const dialog = opened(form, "asks");
    input.focus();
    input.select();
  }

  // Return a form that sets a simulated input which isn't declared, by the controller's variable.
  otherInput() {
    const name = h("input", { name: "variable", placeholder: "M11", autocomplete: "off", spellcheck: "false", maxlength: 40, "aria-label": "Variable or name of an input" });
    const go = (value) => this.app.tried(() => order("input", { name: name.value.trim(), value })).then((made) => made && this.took(name.value.trim(), value, made));
    const form = h("form", { class: "io-other", hidden: true, onsubmit: (event) => event.preventDefault() },
      h("label", {}, "Another input", name),
      h("div", { class: "signal-keys" }, button("OFF", () => name.value.trim() && go(0)), button("ON", () => name.value.trim() && go(1)), button("123", () => name.value.trim() && this.typed(`A value of ${name.value.trim()}`, 0, go))));
    return form;
  }
}

// Return a warning about the consequences of a new value of an output; empty: there is nothing to warn of.
function dangers({ signal, parts }, value) {
  if (signal.kind !== "output") return "";
  if (signal.grips_at !== null && value !== signal.grips_at) return parts.length ? `The gripper opens: ${parts.join(", ")} falls, or stays where it is.` : "The gripper opens: a held part falls.";
  if (signal.grips_at !== null) return "The gripper closes: keep your hands away.";
  if (signal.removes_at === value) return "A machine removes the parts there.";
  if (signal.safe !== null && value !== signal.safe) return `It is ${shownValue(signal.safe)} at a stop: a machine may begin to move.`;
  return "";
}

function asked(title, what) {
  return new Promise((done) => {
    let yes = false;
    const go = () => { yes = true; dialog.close(); };
    const dialog = opened(h("div", { class: "reading" }, h("h2", {}, title), h("p", {}, what), h("div", { class: "actions" }, button("Switch", go, { class: "main" }), button("Cancel", () => dialog.close(), { autofocus: true }))), "asks", () => done(yes));
  });
}
