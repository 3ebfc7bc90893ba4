// The page Calibrate: the tip of a tool, a frame, or the offsets of motors. The server records the robot's position at
// each touch.

import { get, post, remove } from "/api.js";
import { button, h, put } from "/dom.js";
import { Sheet } from "/program/sheet.js";
import { beginning } from "/setup/calibration/beginning.js";
import { Looking } from "/setup/calibration/looking.js";
import { picture } from "/setup/calibration/pictures.js";
import { resultOf, spreadOf, touchesOf } from "/setup/calibration/results.js";
import { Writing } from "/setup/calibration/writing.js";

const EACH = 3000; // time between two requests [ms]: another page or another user may have continued the calibration
const LOOKS = 500;
const TITLES = { tip: "Tool tip", frame: "Frame", home: "Joint offsets" };

export function calibratePage(place, app) {
  style();
  const page = new CalibratePage(place, app);
  return () => page.close();
}

class CalibratePage {
  constructor(place, app) {
    this.app = app;
    this.told = null;
    this.element = h("div", { class: "calibration" });
    const whole = h("div", { class: "calibrating" }, this.element);
    put(place, h("h1", { class: "hidden" }, "Calibrate"), whole);
    this.sheet = new Sheet(whole);
    this.looking = new Looking(this);
    this.writing = new Writing(this);
    this.ending = new AbortController();
    app.robot.addEventListener("display", () => this.refresh(), { signal: this.ending.signal });
    this.asking = setInterval(() => this.ask(), EACH);
    // control of the robot may change without a display message
    this.looks = setInterval(() => this.refresh(), LOOKS);
    this.ask();
  }

  async ask() {
    const told = await get("/api/calibration").catch(() => null);
    if (told && !this.ending.signal.aborted) this.take(told);
  }

  take(told) {
    if (this.told && this.told.version === told.version && this.told.mine === told.mine && this.told.kind === told.kind) return;
    this.told = told;
    this.draw();
  }

  // Request a change. If the calibration was changed elsewhere, show its new state.
  async change(work) {
    try {
      this.take(await work());
    } catch (refused) {
      if (refused.status === 401) return;
      this.app.notice(refused.message, true);
      if (["changed", "gone"].includes(refused.code)) {
        this.told = null;
        this.ask();
      }
    }
  }

  draw() {
    const { told, app } = this;
    this.looking.leave();
    this.taking = null;
    if (!told.kind || !told.mine) {
      const other = told.kind && h("p", { class: "why" }, `${told.by} calibrates ${named(told)}: ${told.touches.length} touches so far.`);
      put(this.element, beginning(app, (wanted) => this.begin(wanted), other));
      return;
    }
    this.taking = button("Take this touch", () => this.touch(), { class: "main", disabled: true });
    this.why = h("p", { class: "hint", role: "status" });
    put(this.element,
      h("section", { class: "step" },
        h("h2", {}, `${TITLES[told.kind]} ${named(told)}`),
        picture(told),
        h("p", { class: "todo", "aria-live": "polite" }, `${told.needed ? `${told.touches.length} of ${told.touches.length + told.needed}: ` : ""}${told.needed || !told.ready ? sentence(told.next) : `Enough touches. To be surer, ${told.next}.`}`),
        h("div", { class: "actions" }, this.taking, button("Jog", () => this.jog()), button("Forget", () => this.forget(), { class: "quiet" })),
        this.why),
      h("div", { class: "outcome" }, resultOf(told), spreadOf(told), told.ready && this.looking.element, told.ready && this.writing.element, touchesOf(told, (at) => this.touch(at), (at) => this.remove(at))));
    if (told.ready) {
      this.looking.draw(told);
      this.writing.draw(told);
    }
    this.refresh();
  }

  refresh() {
    if (!this.taking) return;
    const why = this.idle();
    this.taking.disabled = Boolean(why);
    for (const one of this.element.querySelectorAll(".anew")) one.disabled = Boolean(why);
    if (this.why.textContent !== why) this.why.textContent = why;
    this.looking.refresh();
  }

  // Return the reason why no touch can be recorded now; empty: one can.
  idle() {
    const { display } = this.app.robot;
    if (!this.app.may("programmer")) return "Recording touches needs the role programmer.";
    if (!display?.connected) return "The robot can't be reached.";
    if (display.under_way) return "The robot is under way: wait until it is at rest.";
    if (display.homed === false && this.told.kind !== "home") return "A motor isn't homed: home the robot first.";
    return "";
  }

  begin(wanted) {
    const calibration = { ...wanted };
    this.change(async () => {
      try {
        return await post("/api/calibration", { calibration });
      } catch (refused) {
        if (refused.code !== "going") throw refused;
        const anew = await this.sheet.ask("Another calibration is in progress", h("p", {}, `${refused.message}.`), [["Begin anew", true, "main"], ["Cancel", false]]);
        return anew ? post("/api/calibration", { calibration, anew }) : get("/api/calibration");
      }
    });
  }

  touch(at = null) {
    const { version } = this.told;
    this.change(() => post("/api/calibration/touch", { version, at }));
  }

  remove(at) {
    const { version } = this.told;
    this.change(() => post("/api/calibration/remove", { version, at }));
  }

  async forget() {
    const sure = !this.told.touches.length || (await this.sheet.ask("Forget the calibration?", h("p", {}, "Its touches will be lost. Files don't change."), [["Forget", true, "main"], ["Keep", false]]));
    if (sure) this.change(() => remove("/api/calibration"));
  }

  // Open the page Jog, with a link back to this page.
  jog() {
    this.app.back = { href: "#/setup/calibrate", label: "Back to Calibrate" };
    location.hash = "#/jog";
  }

  close() {
    clearInterval(this.asking);
    clearInterval(this.looks);
    this.ending.abort();
    this.looking.close();
    this.sheet.close();
  }
}

function named(told) {
  return told.kind === "home" ? told.name : `{${told.name}}`;
}

export function sentence(text) {
  return text ? `${text[0].toUpperCase()}${text.slice(1)}.` : "";
}

function style() {
  const href = "/setup/calibration/calibration.css";
  if (!document.querySelector(`link[href='${href}']`)) document.head.append(h("link", { rel: "stylesheet", href }));
}
