// The payload of a tool: its mass and center of mass, their effect on the joint torques, and the entry in robot.toml.

import { get, order, post } from "/api.js";
import { button, h, mark, put, text } from "/dom.js";
import { opened } from "/files/asking.js";
import { serviced } from "/service.js";
import { drawTorques } from "/setup/torques.js";

const AXES = ["X", "Y", "Z"];
const MOMENTS = ["Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"];

// Return the section for payloads, the function `take` for the server's message about tools, and `close`.
export function payloads(app) {
  const may = app.may("programmer");
  const names = h("div", { class: "tool-names" });
  const notes = h("p", { class: "said" });
  const restart = h("p", { class: "ask", role: "status", hidden: true });
  const form = new Form(app, () => look());
  const shown = h("div", { class: "torques", "aria-live": "polite" });
  const element = h("section", { class: "payload" }, h("h2", {}, "What tools weigh"), restart, names, notes, form.element, shown);
  let told = null;
  let key = "";

  function take(tools) {
    const now = JSON.stringify([tools.tools, tools.sits_on, tools.file, tools.why_not, tools.restart, tools.without_mass, tools.without_effort]);
    if (now === key) return;
    key = now;
    told = tools;
    restart.hidden = !tools.restart;
    text(restart, tools.restart ? `${tools.file} has changed since the pendant was started: it takes effect after a restart (System > Controller).` : "");
    text(notes, wordsOf(tools, may));
    draw();
  }

  function draw() {
    put(names,
      told.tools.map((tool) => button([h("strong", { class: "filename" }, tool.name), h("span", {}, tool.mass === null ? "no mass given" : `${tool.mass} kg`), !tool.mounted && h("span", { class: "soft" }, "not mounted")].filter(Boolean),
        () => pick(tool), { class: "pick", disabled: !may, "aria-pressed": String(form.tool?.name === tool.name) })),
      may && button(told.tools.length ? "Another tool" : "Enter a tool", () => pick(null), { class: "pick" }));
  }

  function pick(tool) {
    form.open(tool, told.sits_on);
    put(shown);
    draw();
    form.element.scrollIntoView({ block: "nearest" });
  }

  async function look() {
    const payload = form.payload();
    if (!payload) return;
    put(shown, h("p", {}, "Computing."));
    const found = await app.tried(async () => post("/api/tools/payload", { ...payload, program: await form.program() }));
    if (!found) return put(shown);
    drawTorques(shown, found, () => write(payload, found), app.may("service"));
  }

  async function write(payload, found) {
    const { compared } = await import("/program/comparing.js");
    const { host, close } = compared(found.before, found.after, []);
    const go = button("Write it", async () => {
      const made = await serviced(app, () => post("/api/tools/payload/save", { ...payload, known: found.known }));
      if (!made) return;
      dialog.close();
      put(shown);
      app.notice(`${made.file} was written; the previous file is kept in Files > Deleted. It takes effect after a restart (System > Controller).`);
      await get("/api/tools").then(take, () => {});
    }, { class: "main", disabled: Boolean(found.why_not) || !found.sound || found.before === found.after });
    const said = found.why_not || (found.before === found.after ? "Nothing would change." : "");
    const dialog = opened(h("div", { class: "reading" }, h("h2", { class: "filename" }, found.file), said && h("p", { class: "said" }, said), host,
      h("div", { class: "actions" }, go, button("Cancel", () => dialog.close()))), "shows", close);
  }

  if (!may) form.element.hidden = true;
  return { element, take, close: () => {} };
}

// Return sentences about unknown masses and torques of the robot, with remedies.
function wordsOf(tools, may) {
  const words = [];
  if (!tools.tools.length) words.push("robot.toml has no tool: so far the load on the flange is taken as 0 kg.");
  if (tools.without_mass.length) words.push(`What ${tools.without_mass.join(", ")} ${tools.without_mass.length > 1 ? "move" : "moves"} has no mass: add <inertial> to the links of the URDF. Until then only the torques due to the tool are known.`);
  if (tools.without_effort.length) words.push(`The largest torque of ${tools.without_effort.join(", ")} is unknown: add effort to [joints.NAME] of robot.toml.`);
  if (!tools.checked) words.push("Programs aren't checked for torques.");
  if (tools.why_not) words.push(`${tools.why_not}.`);
  if (!may) words.push("Trying a payload needs the role programmer; writing it needs the role service.");
  return words.join(" ");
}

// The form for a payload.
class Form {
  constructor(app, look) {
    this.app = app;
    this.tool = null;
    const number = (name, label) => h("input", { name, type: "number", step: "any", inputmode: "decimal", autocomplete: "off", "aria-label": label });
    this.name = h("input", { name: "tool", autocomplete: "off", spellcheck: "false", maxlength: 40, placeholder: "GRIPPER" });
    this.frame = h("select", { name: "frame" });
    this.mass = number("mass", "Mass, kg");
    this.center = AXES.map((axis) => number(`center_${axis.toLowerCase()}`, `Centre of mass, ${axis}, mm`));
    this.known = h("input", { type: "checkbox", onchange: () => this.fit() });
    this.inertia = MOMENTS.map((name) => number(name.toLowerCase(), `${name}, kg m^2`));
    this.programs = h("select", { name: "program" }, h("option", { value: "" }, "none"));
    this.moments = h("div", { class: "fields three" }, this.inertia.map((input, at) => h("label", {}, `${MOMENTS[at]} kg m²`, input)));
    this.assumed = h("p", { class: "said" }, "Without moments of inertia the mass is treated as a point: torques at rest are exact, but quick turns of the wrist need more.");
    this.fresh = h("div", { class: "fields two" }, h("label", {}, "Name", this.name), h("label", {}, "Sits in", this.frame));
    this.element = h("form", { class: "payload-form", hidden: true, onsubmit: (event) => { event.preventDefault(); look(); } },
      this.title = h("h2", {}), this.fresh,
      h("div", { class: "fields four" }, h("label", {}, "Mass kg", this.mass), this.center.map((input, at) => h("label", {}, `Centre ${AXES[at]} mm`, input))),
      h("label", { class: "check" }, this.known, "The moments of inertia are known"), this.moments, this.assumed,
      h("label", { class: "select" }, "Program for the torques", this.programs),
      h("div", { class: "actions" }, h("button", { type: "submit", class: "main" }, "Effect on the torques")));
  }

  open(tool, frames) {
    this.tool = tool;
    this.element.hidden = !this.app.may("programmer");
    text(this.title, tool ? `${tool.name}, seen from {${tool.frame}}${tool.mounted ? "" : ": not mounted, so its mass doesn't count"}` : "Another tool");
    this.fresh.hidden = Boolean(tool);
    put(this.frame, frames.map((name) => h("option", { value: name }, `{${name}}`)));
    this.frame.value = frames.includes("TCP") ? "TCP" : frames[0];
    this.mass.value = tool?.mass ?? "";
    this.center.forEach((input, at) => { input.value = tool?.center_mm?.[at] ?? 0; });
    this.known.checked = Boolean(tool?.inertia);
    this.inertia.forEach((input, at) => { input.value = tool?.inertia?.[at] ?? 0; });
    this.fit();
    this.list();
  }

  fit() {
    this.moments.hidden = !this.known.checked;
    this.assumed.hidden = this.known.checked;
  }

  async list() {
    const told = await get("/api/programs").catch(() => null);
    const before = this.programs.value;
    put(this.programs, h("option", { value: "" }, "none"), (told?.programs ?? []).map(({ file }) => h("option", { value: file }, file)));
    this.programs.value = before;
  }

  // Return the entered payload; null, with a message, if a value is missing.
  payload() {
    const values = (inputs) => inputs.map((input) => (input.value.trim() === "" ? NaN : Number(input.value)));
    const [mass] = values([this.mass]);
    const center = values(this.center);
    const inertia = this.known.checked ? values(this.inertia) : null;
    for (const [input, value] of [[this.mass, mass], ...this.center.map((one, at) => [one, center[at]]), ...(inertia ?? []).map((one, at) => [this.inertia[at], one])]) {
      mark(input, "aria-invalid", String(!Number.isFinite(value)));
      if (!Number.isFinite(value)) {
        this.app.notice(`${input.getAttribute("aria-label")}: enter a number.`, true);
        return null;
      }
    }
    const name = this.tool ? this.tool.name : this.name.value.trim();
    if (!name) {
      this.app.notice("Enter a name of the tool.", true);
      return null;
    }
    return { tool: name, frame: this.tool ? null : this.frame.value, mass, center_mm: center, inertia };
  }

  // Load the chosen program and return its number; null: none is chosen, or it can't be proved.
  async program() {
    if (!this.programs.value) return null;
    const told = await order("load", { file: this.programs.value });
    if (told.program) return told.program.number;
    this.app.notice(`${this.programs.value} can't be proved: ${told.findings.find(({ severity }) => severity === "error")?.message ?? "look at the page Run"}`, true);
    return null;
  }
}
