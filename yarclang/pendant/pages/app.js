// The app: login, choice of the page, and the state that all pages share.

import { Robot, get, post } from "/api.js";
import { Devices } from "/devices.js";
import { button, h, put } from "/dom.js";
import { entrance } from "/entrance.js";
import { filesPage } from "/files/files.js";
import { renew, settle } from "/frames.js";
import { Holding } from "/holding.js";
import { jogPage } from "/jog.js";
import { mappingPage } from "/mapping.js";
import { accountPage, peoplePage } from "/people.js";
import { runPage } from "/playback/page.js";
import { Shell } from "/shell.js";
import { statusPage } from "/status.js";
import { tabbed } from "/tabs.js";

// Return a page whose files are loaded when it is first shown, because its libraries are large.
function later(path, name) {
  return (place, app, rest) => {
    let left = false;
    let inner = () => {};
    const shown = (page) => left || (inner = page[name](place, app, rest) ?? inner);
    import(path).then(shown, () => app.notice("The page can't be loaded: check the connection.", true));
    const leave = () => {
      left = true;
      inner();
    };
    leave.asks = () => inner.asks?.() ?? true;
    return leave;
  };
}

const RANKS = ["viewer", "operator", "programmer", "service"];
const SETUP = [
  ["tools", "Tools and frames", later("/setup/tools.js", "toolsPage"), "viewer"],
  ["calibrate", "Calibrate", later("/setup/calibrate.js", "calibratePage"), "viewer"],
  ["workspace", "Workspace", later("/setup/workspace.js", "workspacePage"), "viewer"],
];
const HISTORY = [
  ["alarms", "Alarms", later("/history/alarms.js", "alarmsPage"), "viewer"],
  ["runs", "Runs", later("/history/runs.js", "runsPage"), "viewer"],
];
const SYSTEM = [
  ["controller", "Controller", later("/system/controller.js", "controllerPage"), "viewer"],
  ["health", "Health", later("/system/health.js", "healthPage"), "viewer"],
  ["backup", "Backup", later("/system/backup.js", "backupPage"), "service"],
  ["users", "Users", peoplePage, "service"],
  ["keys", "Joystick", mappingPage, "viewer"],
  ["account", "Account", accountPage, "viewer"],
];
const PAGES = [
  ["run", "Run", runPage, "viewer"],
  ["program", "Program", later("/program/page.js", "programPage"), "viewer"],
  ["jog", "Jog", jogPage, "viewer"],
  ["scene", "3D", later("/scene/page.js", "scenePage"), "viewer"],
  ["io", "I/O", later("/io/page.js", "ioPage"), "viewer"],
  ["setup", "Setup", tabbed("setup", SETUP), "viewer"],
  ["files", "Files", filesPage, "viewer"],
  ["history", "History", tabbed("history", HISTORY), "viewer"],
  ["status", "Status", statusPage, "viewer"],
  ["system", "System", tabbed("system", SYSTEM), "viewer"],
];

class App {
  constructor() {
    this.me = null;
    this.leavePage = () => {};
    this.again = () => {};
    this.place = {
      entrance: document.getElementById("entrance"),
      pendant: document.getElementById("pendant"),
      page: document.getElementById("page"),
      rail: document.getElementById("rail"),
      notices: document.getElementById("notices"),
    };
    document.addEventListener("loggedout", () => this.me && this.close("You were logged out."));
    window.addEventListener("hashchange", () => this.me && this.show());
    theme(localStorage.getItem("yarc.theme") ?? "auto");
  }

  async start() {
    try {
      this.open(await get("/api/me"));
    } catch (refused) {
      this.enter(refused);
    }
  }

  enter(refused, said = "") {
    this.place.pendant.hidden = true;
    this.place.entrance.hidden = false;
    const token = new URLSearchParams(location.hash.slice(1)).get("first") ?? "";
    entrance(this.place.entrance, { first: Boolean(refused?.told?.first), token, said }, (me) => this.open(me));
  }

  async open(me) {
    this.me = me;
    this.place.entrance.hidden = true;
    this.place.pendant.hidden = false;
    this.robot = new Robot();
    this.robot.addEventListener("finished", ({ detail }) => detail.name === "jog" || renew(this));
    this.robot.addEventListener("back", () => this.again());
    this.holding = new Holding();
    this.devices = new Devices(this);
    this.shell = new Shell(this);
    await this.describe();
    if (location.hash.startsWith("#first=") || !location.hash) history.replaceState(null, "", "#/run");
    this.show();
  }

  // Request the robot's description. Called again when the server can be reached again.
  async describe() {
    try {
      this.about = await get("/api/robot");
      document.title = `${this.about.name} – TCPad`;
      this.shell.about();
      this.robot.dispatchEvent(new Event("frames"));
      settle(this);
    } catch (refused) {
      this.about = null;
      this.notice(refused.message, true);
    }
  }

  // Settings of jogs. The browser stores them for each user.
  get jog() {
    this.jogSettings ??= { share: 0.1, step: 0, kind: "joint", axes: "{B}", moving: "{TCP}", ...this.recall("jog") };
    return this.jogSettings;
  }

  recall(what) {
    try {
      return JSON.parse(localStorage.getItem(`yarc.${this.me.user}.${what}`)) ?? {};
    } catch {
      return {};
    }
  }

  remember(what, value) {
    localStorage.setItem(`yarc.${this.me.user}.${what}`, JSON.stringify(value));
  }

  may(role) {
    return this.me !== null && RANKS.indexOf(this.me.role) >= RANKS.indexOf(role);
  }

  // True if this session controls the robot.
  get controls() {
    return Boolean(this.me?.client) && this.robot.display?.owner === this.me.client;
  }

  async show() {
    const { hash } = location;
    if (hash === this.shown) return;
    if (this.leavePage.asks) {
      const may = await this.leavePage.asks();
      history.replaceState(null, "", may ? hash : this.shown);
      if (!may) return;
    }
    this.shown = hash;
    const [wanted, ...rest] = hash.replace(/^#\//, "").split("/");
    const pages = PAGES.filter(([, , , role]) => this.may(role));
    const [name, title, page] = pages.find(([known]) => known === wanted) ?? pages[0];
    this.leavePage();
    this.again = () => {};
    forgetQuestions();
    this.holding.releaseAll();
    if (name !== "jog") this.back = null;
    const { scrollTop } = this.place.rail;
    put(
      this.place.rail,
      pages.map(([known, label]) =>
        h("a", { href: `#/${known}`, "aria-current": known === name ? "page" : null, class: known === "program" && known !== name && this.unsaved ? "place unsaved" : "place" }, label),
      ),
      button("Log out", () => this.logout(), { class: "place quiet" }),
    );
    this.place.rail.scrollTop = scrollTop;
    this.place.rail.querySelector("[aria-current=page]").scrollIntoView({ block: "nearest" });
    put(this.place.page, h("h1", { class: "hidden" }, title));
    this.leavePage = page(this.place.page, this, rest.map(decoded).join("/")) ?? (() => {});
  }

  // Set the function that the shown page needs after a lost connection, because replies may have been lost.
  whenBack(work) {
    this.again = work;
  }

  async control() {
    await this.tried(async () => {
      const told = await post("/api/control");
      this.me = await get("/api/me");
      this.shell.refresh();
      if (!told.given) this.notice(told.what);
    });
  }

  async tried(work) {
    try {
      return await work();
    } catch (refused) {
      // the login page or the status bar already shows an ended login or a lost connection
      const told = refused.status === 401 || (refused.status === 0 && this.robot.wasLost && !this.robot.connected);
      if (!told) this.notice(refused.message, true);
      return null;
    }
  }

  notice(what, warning = false, ...actions) {
    // a notice replaces an earlier one with the same text, unless it asks a question
    const said = [...this.place.notices.children].find((one) => one.firstChild.textContent === what);
    if (said && !actions.length) said.remove();
    const shown = h("div", { class: warning ? "notice warning" : "notice" }, h("span", {}, what), ...actions);
    shown.append(button("Close", () => shown.remove(), { class: "quiet" }));
    this.place.notices.append(shown);
    while (this.place.notices.children.length > 3) this.place.notices.firstChild.remove();
    if (!actions.length) setTimeout(() => shown.remove(), warning ? 12000 : 5000);
    return shown;
  }

  async logout() {
    // a failed logout must be visible: otherwise the next person would work under this user's name
    if (await this.tried(() => post("/api/logout"))) this.close("");
  }

  close(said) {
    this.me = null;
    this.shown = null;
    this.leavePage();
    this.leavePage = () => {};
    this.again = () => {};
    forgetQuestions();
    this.unsaved = this.left = undefined;
    this.holding.close();
    this.devices.close();
    this.shell.close();
    this.robot.close();
    this.jogSettings = undefined;
    get("/api/me").then((me) => this.open(me), (refused) => this.enter(refused, said));
  }
}

// Close all open questions. A question without an answer counts as answered with no.
function forgetQuestions() {
  for (const dialog of document.querySelectorAll("dialog[open]")) dialog.close();
}

// Decode a part of the address; return it unchanged if that is impossible.
function decoded(part) {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

export function theme(name) {
  document.documentElement.dataset.theme = name;
  localStorage.setItem("yarc.theme", name);
}

new App().start();
