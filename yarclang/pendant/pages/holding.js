// Hold-to-run: buttons pressed by finger, key or joystick start a jog. The release of any of them ends it.
//
// While a button is pressed, the page sends the requested motion 20 times a second, with the last heartbeat that it has
// received. If these messages stop, the robot comes to rest.

import { jogSocket } from "/api.js";

const EACH = 50;

export class Holding extends EventTarget {
  constructor() {
    super();
    this.held = new Map(); // pressed buttons: source of the press, and the motion that it requests
    this.blocked = false; // true after a release, until all buttons are released
    this.press = 0;
    this.last = 0;
    this.beat = 0;
    this.settings = () => ({});
    this.open();
    const letGo = () => this.releaseAll();
    window.addEventListener("blur", letGo);
    window.addEventListener("pagehide", letGo);
    document.addEventListener("freeze", letGo);
    document.addEventListener("visibilitychange", () => document.hidden && letGo());
    this.ticking = setInterval(() => this.tick(), EACH);
  }

  open() {
    this.socket = jogSocket();
    const mine = this.socket;
    mine.onmessage = (event) => {
      const told = JSON.parse(event.data);
      if (told.beat) this.beat = told.beat;
      else if (told.press) this.hear(told);
      else if (told.ok === false) this.tell("ended", told.error, told.help);
    };
    mine.onclose = (event) => {
      if (mine !== this.socket) return;
      if (this.press) this.over("ended", "the connection to the pendant's server is lost");
      if (event.code !== 4401 && !this.closed) setTimeout(() => this.open(), 500);
    };
  }

  get moving() {
    return this.press > 0;
  }

  // Begin a press. `want` is the requested motion: {joint, sign} or {axis, sign}; for a joystick {joints} or {twist},
  // with values from -1 to 1.
  hold(source, want) {
    if (this.held.has(source)) {
      this.held.set(source, want);
      return;
    }
    this.held.set(source, want);
    if (this.blocked || this.held.size > 1) {
      if (this.press) this.say();
      return;
    }
    if (this.socket.readyState !== WebSocket.OPEN) {
      this.tell("ended", "there is no connection to the pendant's server");
      return;
    }
    this.press = ++this.last;
    this.say();
    this.dispatchEvent(new Event("begun"));
  }

  // End a press. This ends the jog even if other buttons are still pressed.
  release(source) {
    if (!this.held.delete(source)) return;
    this.end();
    this.blocked = this.held.size > 0;
  }

  releaseAll() {
    this.held.clear();
    this.blocked = false;
    this.end();
  }

  // End an offered motion that rests on its path, because the user has left the page with its button.
  leave() {
    this.releaseAll();
    if (this.last && this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ release: this.last, end: true }));
  }

  end() {
    if (!this.press) return;
    const ended = this.press;
    this.press = 0;
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ release: ended }));
    this.dispatchEvent(new Event("released"));
  }

  tick() {
    if (this.press) this.say();
  }

  say() {
    const wanted = this.wanted();
    if (wanted && this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(JSON.stringify({ press: this.press, beat: this.beat, ...wanted }));
    }
  }

  // Return the motion that all pressed buttons request together.
  wanted() {
    const { share = 0.1, step = 0, axes = "{B}", moving = "{TCP}", robot } = this.settings();
    const wants = [...this.held.values()];
    if (wants[0]?.go) return { go: wants[0].go };
    if (wants[0]?.home) return { home: wants[0].home };
    if (!wants.length || !robot) return null;
    const common = { share, axes, moving };
    const [one] = wants;
    if (step && one.sign) {
      return { step: { axis: one.joint ?? one.axis, by: one.sign * step }, ...common };
    }
    if (one.joint || one.joints) {
      const parts = Object.assign({}, ...wants.map((want) => want.joints ?? { [want.joint]: want.sign }));
      const known = robot.joints.filter(({ name }) => parts[name] !== undefined);
      const velocity = Object.fromEntries(known.map((joint) => [joint.name, parts[joint.name] * share * joint.velocity]));
      return { velocity, ...common };
    }
    const twist = [0, 0, 0, 0, 0, 0];
    for (const want of wants) {
      const parts = want.twist ?? [..."xyzabc"].map((axis) => (axis === want.axis ? want.sign : 0));
      parts.forEach((part, number) => {
        twist[number] += part * share * (number < 3 ? robot.jog_speed_mm_s : robot.jog_turn_deg_s);
      });
    }
    return { twist, ...common };
  }

  hear(told) {
    if (told.press !== this.last) return;
    if (told.state === "moves") {
      if (this.press === told.press) this.tell("moves", told.why); // otherwise the message crossed the release of the button
    } else if (this.press === told.press) this.over(told.state, told.why, told.help, told.code);
    else if (told.why) this.tell(told.state, told.why, told.help);
  }

  // Handle the end of a jog by the server. Pressed buttons have to be released before another jog can begin.
  over(state, why, help, code) {
    this.press = 0;
    this.blocked = this.held.size > 0;
    this.dispatchEvent(new Event("released"));
    this.tell(state, why, help, code);
  }

  tell(state, why, help, code) {
    this.dispatchEvent(new CustomEvent("told", { detail: { state, why: why ?? "", help: help ?? "", code: code ?? "" } }));
  }

  close() {
    this.closed = true;
    clearInterval(this.ticking);
    this.releaseAll();
    this.socket.close();
  }
}

// Make an element a hold-to-run button for finger, mouse, pen, and the keys that press a button.
export function holdable(element, holding, source, want) {
  const press = (event) => {
    if (event.button) return;
    event.preventDefault();
    element.setPointerCapture?.(event.pointerId);
    element.focus({ preventScroll: true });
    holding.hold(source, want());
  };
  const release = (event) => {
    if (event.type === "pointerup") swallowClick();
    holding.release(source);
  };
  element.addEventListener("pointerdown", press);
  for (const name of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) element.addEventListener(name, release);
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("keydown", (event) => {
    if (event.key !== " " && event.key !== "Enter") return;
    event.preventDefault();
    if (!event.repeat) holding.hold(source, want());
  });
  element.addEventListener("keyup", (event) => {
    if (event.key === " " || event.key === "Enter") release(event);
  });
}

// Ignore the click that follows a release. The layout may have changed during the press, so the click could hit another
// element.
function swallowClick() {
  const swallow = (event) => event.stopPropagation();
  document.addEventListener("click", swallow, { capture: true, once: true });
  setTimeout(() => document.removeEventListener("click", swallow, { capture: true }), 200);
}
