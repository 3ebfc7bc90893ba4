// Joysticks and keyboard keys, as the user has mapped them to jogging, enabling, hold, stop and run.

import { order } from "/api.js";

const NEUTRAL = 0.15;
export const TARGETS = ["x", "y", "z", "a", "b", "c"];
export const DEFAULT = {
  enable: 0,
  axes: [
    { to: "y", sign: -1 },
    { to: "x", sign: -1 },
    { to: "", sign: 1 },
    { to: "z", sign: -1 },
  ],
  keys: {},
};

// Actions other than jogging to which a key can be mapped.
export const DEEDS = ["enable", "stop", "hold", "run"];

export class Devices extends EventTarget {
  constructor(app) {
    super();
    this.app = app;
    this.map = { ...structuredClone(DEFAULT), ...app.recall("devices") };
    this.pressed = new Set();
    this.neutral = false;
    this.jogging = false;
    this.learning = null;
    this.ending = new AbortController();
    const { signal } = this.ending;
    window.addEventListener("keydown", (event) => this.down(event), { signal, capture: true });
    window.addEventListener("keyup", (event) => this.up(event), { signal, capture: true });
    window.addEventListener("blur", () => this.pressed.clear(), { signal });
    window.addEventListener("gamepaddisconnected", () => this.app.holding.release("joystick"), { signal });
    this.looking = setInterval(() => this.look(), 25);
  }

  keep() {
    this.app.remember("devices", this.map);
  }

  // The first connected joystick; null: none.
  get pad() {
    return [...navigator.getGamepads()].find((one) => one?.connected) ?? null;
  }

  // Return the joystick's deflections as a twist, from -1 to 1. Small deflections count as zero.
  parts(pad) {
    const twist = [0, 0, 0, 0, 0, 0];
    this.map.axes.forEach(({ to, sign }, number) => {
      const raw = pad.axes[number] ?? 0;
      const value = Math.abs(raw) < NEUTRAL ? 0 : (raw - Math.sign(raw) * NEUTRAL) / (1 - NEUTRAL);
      const target = TARGETS.indexOf(to);
      if (target >= 0) twist[target] += sign * Math.max(-1, Math.min(1, value));
    });
    return twist;
  }

  get isJogPage() {
    return location.hash.startsWith("#/jog");
  }

  look() {
    const { holding } = this.app;
    const pad = this.pad;
    if (!pad || !this.isJogPage || document.hidden) {
      if (this.jogging) this.end();
      return;
    }
    const twist = this.parts(pad);
    const enabled = Boolean(pad.buttons[this.map.enable]?.pressed);
    const deflected = twist.some((part) => part !== 0);
    // a stick that was deflected before enabling must first return to neutral
    if (!enabled || !deflected) this.neutral = !deflected;
    if (!enabled) {
      if (this.jogging) this.end();
      return;
    }
    if (!this.jogging && !(deflected && this.neutral)) return;
    this.jogging = true;
    const { kind } = this.app.jog;
    if (kind === "joint") {
      const joints = Object.fromEntries((this.app.about?.joints ?? []).slice(0, 6).map(({ name }, number) => [name, twist[number]]));
      holding.hold("joystick", { joints });
    } else {
      holding.hold("joystick", { twist });
    }
  }

  end() {
    this.jogging = false;
    this.neutral = false;
    this.app.holding.release("joystick");
  }

  isTyping(event) {
    return event.target instanceof HTMLElement && event.target.matches("input:not([type=range]):not([type=radio]):not([type=checkbox]), textarea, select");
  }

  down(event) {
    if (this.learning) {
      event.preventDefault();
      event.stopPropagation();
      const learn = this.learning;
      this.learning = null;
      learn(event.code);
      return;
    }
    const deed = this.map.keys[event.code];
    if (!deed || this.isTyping(event)) return;
    event.preventDefault();
    event.stopPropagation();
    if (event.repeat) return;
    this.pressed.add(event.code);
    if (deed === "stop") this.app.shell.stopNow();
    else if (deed === "hold") this.app.tried(() => order("hold"));
    else if (deed === "run") this.app.tried(() => order("resume"));
    else if (deed !== "enable" && this.isJogPage && this.isEnabled()) this.app.holding.hold(`key ${event.code}`, this.want(deed));
  }

  up(event) {
    if (!this.pressed.delete(event.code)) return;
    event.preventDefault();
    event.stopPropagation();
    if (this.map.keys[event.code] === "enable") this.app.holding.releaseAll();
    else this.app.holding.release(`key ${event.code}`);
  }

  // Return true if keys may jog: if a key is mapped to enable, it must be pressed.
  isEnabled() {
    const enabling = Object.entries(this.map.keys).filter(([, deed]) => deed === "enable");
    return !enabling.length || enabling.some(([code]) => this.pressed.has(code));
  }

  // Return the motion for a mapping such as `x+`. In joint mode, x is the first joint, y the second, and so on.
  want(deed) {
    const sign = deed.endsWith("-") ? -1 : 1;
    const axis = deed[0];
    if (this.app.jog.kind !== "joint") return { axis, sign };
    return { joint: this.app.about?.joints[TARGETS.indexOf(axis)]?.name, sign };
  }

  close() {
    this.ending.abort();
    clearInterval(this.looking);
  }
}
