// Choice of a program of the project, and creation of a new program from a template.

import { call, get, post } from "/api.js";
import { button, h, put } from "/dom.js";
import { Fields } from "/program/fields.js";
import { addressAt } from "/program/file.js";

const addressOf = (file) => `#/program/${file.split("/").map(encodeURIComponent).join("/")}`;

export const goTo = (file) => (location.hash = addressOf(file));

export async function choose(page) {
  const told = await page.app.tried(() => get("/api/programs"));
  if (!told) return;
  const programs = told.programs.filter((one) => one.file.toLowerCase().endsWith(".yarc"));
  const list = h("div", { class: "picks" });
  const search = h("input", { type: "search", placeholder: "Search programs", "aria-label": "Search programs", oninput: () => draw() });
  const draw = () => {
    const wanted = search.value.toLowerCase();
    const shown = programs.filter((one) => one.file.toLowerCase().includes(wanted)).slice(0, 300);
    put(list, shown.map((one) => button([h("strong", {}, one.file), h("span", { class: "soft" }, `changed ${one.changed.slice(0, 16).replace("T", " ")}`)], () => (page.sheet.close(), goTo(one.file)), { class: "pick" })));
    if (!shown.length) put(list, h("p", {}, programs.length ? "No program has this name." : "There is no program in the project."));
  };
  const buttons = [["Cancel"]];
  if (page.app.may("programmer")) buttons.unshift(["New program", () => begin(page), "main"]);
  page.sheet.open("Choose a program", [search, list], buttons);
  draw();
}

export async function begin(page) {
  const told = await page.app.tried(() => get("/api/program/templates"));
  if (!told) return;
  const pick = (one) => button([h("strong", {}, one.title), one.summary ? h("span", { class: "soft" }, one.summary) : null].filter(Boolean), () => name(page, one), { class: "pick" });
  page.sheet.open("New program", h("div", { class: "picks" }, told.templates.map(pick)), [["Cancel"]]);
}

function name(page, template) {
  const file = h("input", { name: "file", placeholder: "name.yarc", autocomplete: "off", spellcheck: "false" });
  const fields = new Fields(template.fields ?? []);
  const done = async () => {
    const wanted = file.value.trim();
    const path = wanted.toLowerCase().endsWith(".yarc") ? wanted : `${wanted}.yarc`;
    const made = wanted && (await page.app.tried(() => post("/api/program/new", { template: template.name, file: path, fields: fields.all })));
    if (made && (await page.app.tried(() => call("PUT", addressAt(path), { text: made.text, known: null })))) goTo(path);
  };
  page.sheet.open(`New: ${template.title}`, [h("label", {}, "File", file), fields.place], [["Make", done, "main"], ["Cancel"]]);
}
