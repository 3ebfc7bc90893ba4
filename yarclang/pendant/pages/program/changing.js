// Changes of the program by the page's buttons. The server computes the edits; the editor applies them as one step.

import { post } from "/api.js";
import { button, h } from "/dom.js";
import { Fields } from "/program/fields.js";

const MOTIONS = [["MOVEJ", "freely"], ["MOVEL", "straight"], ["MOVEC", "in an arc"], ["DMOVE", "by so much"]];

export class Changing {
  constructor(page) {
    this.page = page;
    this.app = page.app;
  }

  // Let the server compute a change, and apply it. Nothing is changed if the user edits the text before the reply
  // arrives.
  async change(change, doc = this.page.editor.doc) {
    const { editor, file } = this.page;
    if (doc !== editor.doc) return this.late();
    const told = await this.app.tried(() => post("/api/program/edit", { file: file.file, text: doc.toString(), change }));
    if (!told) return false;
    if (doc !== editor.doc) return this.late();
    editor.apply(told.edits, told.line);
    await this.page.list();
    if (told.what) this.page.say(told.what);
    return true;
  }

  late() {
    this.app.notice("The text has changed meanwhile: nothing was changed. Try again.", true);
    return false;
  }

  // The last line of the selection. New lines are inserted after it.
  get after() {
    const last = this.page.rows.selected.at(-1);
    const [, line] = this.page.editor.lines;
    return last ? Math.max(last.line + last.rows - 1, line) : line;
  }

  get selected() {
    return this.page.rows.selected.at(-1);
  }

  teach() {
    const wanted = { motion: "MOVEJ", target: "joints", axes: "base", ...this.app.recall("teach") };
    const choice = (name, label, values) =>
      h("fieldset", {}, h("legend", {}, label), h("div", { class: "choice" }, values.map(([value, word]) => h("label", {}, h("input", { type: "radio", name: `teach-${name}`, value, checked: wanted[name] === value, onchange: () => ((wanted[name] = value), show()) }), h("span", {}, word)))));
    const written = (label, attributes) => h("label", {}, label, h("input", { autocomplete: "off", spellcheck: "false", maxlength: 60, ...attributes }));
    const name = written("Name of the point", { name: "teach-name", placeholder: "no name" });
    const time = written("Speed or time", { name: "teach-time", placeholder: "as DEFAULT; or 50%, V 100, 4" });
    const motions = choice("motion", "Motion", MOTIONS.map(([word, meant]) => [word, [word, h("small", {}, meant)]]));
    const targets = choice("target", "Target", [["joints", "Joints"], ["pose", "Pose"]]);
    const axes = choice("axes", "Along the axes of", [["base", "the base frame"], ["tool", "the tool"]]);
    const hint = h("p", { class: "hint" });
    const show = () => {
      const via = wanted.motion === "MOVEC" && !this.via;
      hint.textContent = via
        ? "The robot's position becomes the via point of the arc. Then jog to the end of the arc, and teach again."
        : wanted.motion === "MOVEC" ? "The arc passes through the recorded via point, and ends at the robot's position." : "The motion ends at the robot's position.";
      targets.hidden = wanted.motion !== "MOVEJ";
      axes.hidden = wanted.motion !== "DMOVE";
      name.hidden = !axes.hidden;
      time.hidden = via;
      const main = this.page.sheet.place.querySelector(".main");
      if (main) main.textContent = via ? "Take via point" : "Teach";
    };
    const done = () => {
      this.app.remember("teach", wanted);
      if (wanted.motion === "MOVEC" && !this.via) this.takeVia();
      else this.taught(wanted, name.control.value.trim(), time.control.value.trim());
    };
    this.page.sheet.open(
      "Teach here",
      [motions, targets, axes, h("div", { class: "fields" }, name, time), hint],
      [["Teach", done, "main"], ["Cancel"]],
      "small",
    );
    show();
  }

  get via() {
    return this.app.teachingVia;
  }

  takeVia() {
    const joints = this.app.robot.display?.joints;
    if (!joints || joints.includes(null)) {
      this.app.notice("The robot's position is unknown: connect it first.", true);
      return;
    }
    this.app.teachingVia = joints;
    this.page.refresh();
  }

  dropVia() {
    this.app.teachingVia = null;
    this.page.refresh();
  }

  async taught({ motion, target, axes }, name, time) {
    const change = { kind: "teach", after: this.after, motion, target: motion === "MOVEJ" ? target : "pose" };
    if (motion === "MOVEC") change.via = this.via;
    if (motion === "DMOVE") change.axes = axes;
    else if (name) change.name = name;
    if (time) change.time = time;
    await this.page.current();
    if (await this.change(change)) this.dropVia();
  }

  touchUp() {
    return this.change({ kind: "touch-up", line: this.selected.line });
  }

  async insert() {
    const told = await this.app.tried(() => post("/api/program/forms", { file: this.page.file.file, text: this.page.editor.text }));
    if (!told) return;
    const pick = (form) => button([h("strong", {}, form.label), h("span", { class: "soft" }, form.summary)], () => this.fill(form), { class: "pick" });
    this.page.sheet.open("Insert", h("div", { class: "picks" }, told.forms.map(pick)), [["Cancel"]]);
  }

  fill(form) {
    const fields = new Fields(form.fields);
    const done = async () => {
      await this.page.current();
      await this.change({ kind: "insert", after: this.after, command: form.command, fields: fields.all });
    };
    this.page.sheet.open(form.label, [h("p", { class: "hint" }, form.summary), fields.place], [["Insert", done, "main"], ["Cancel"]]);
  }

  edit() {
    const { line, name, fields } = this.selected;
    const made = new Fields(fields);
    const { doc } = this.page.editor;
    const done = () => Object.keys(made.changed).length && this.change({ kind: "change", line, fields: made.changed }, doc);
    this.page.sheet.open(`${name} in line ${line}`, made.place, [["Change", done, "main"], ["Cancel"]]);
  }

  remove() {
    const rows = this.page.rows.selected;
    const last = rows.at(-1);
    return this.change({ kind: "delete", lines: [rows[0].line, last.line + last.rows - 1] });
  }

  // Move the selected command or block up or down by one command. A neighbouring block counts as one command.
  move(step) {
    const { rows, editor } = this.page;
    const { commands, first } = rows;
    const { depth } = commands[first];
    const end = (at) => {
      let to = at;
      if (commands[at]?.kind === "block") while (to + 1 < commands.length && !(commands[to].kind === "end" && commands[to].depth === commands[at].depth)) to++;
      return to;
    };
    let other;
    if (step < 0) {
      other = first - 1;
      while (other > 0 && (commands[other].depth > depth || (commands[other].kind === "end" && commands[other].depth === depth))) other--;
    } else other = end(end(first) + 1) + 1;
    return this.change({ kind: "move", line: this.selected.line, before: commands[other]?.line ?? editor.doc.lines + 1 });
  }

  renumber() {
    return this.change({ kind: "renumber" });
  }

  declare(what) {
    const name = h("input", { name: "declared", autocomplete: "off", spellcheck: "false", maxlength: 60 });
    const done = () => name.value.trim() && this.change({ kind: "declare", what, name: name.value.trim() });
    this.page.sheet.open({ frame: "Name this frame", pose: "Name this pose", joints: "Name these joints" }[what], h("label", {}, "Name", name), [["Declare", done, "main"], ["Cancel"]], "small");
  }
}
