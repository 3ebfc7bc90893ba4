// A sheet over the page that asks or shows something. It isn't modal: STOP and the bar stay what they are.

import { button, h, put } from "/dom.js";

export class Sheet {
  constructor(place) {
    this.place = h("section", { class: "sheet", role: "dialog", hidden: true, tabindex: -1 });
    place.append(this.place);
  }

  // Show content and buttons ([label, act, class]); a button closes the sheet first.
  open(title, content, buttons, kind = "") {
    this.closing?.();
    this.closing = null;
    put(
      this.place,
      h("h2", {}, title),
      h("div", { class: "sheet-content" }, content),
      h("div", { class: "actions" }, buttons.map(([label, act, look]) => button(label, () => (this.close(), act?.()), { class: look || null }))),
    );
    this.place.className = `sheet ${kind}`;
    this.place.setAttribute("aria-label", title);
    this.place.hidden = false;
    (this.place.querySelector("input, select") ?? this.place.querySelector(".main") ?? this.place).focus({ preventScroll: true });
  }

  // Ask for one of several answers; the last one is that of a sheet which is closed otherwise.
  ask(title, content, buttons) {
    return new Promise((done) => {
      this.open(title, content, buttons.map(([label, value, look]) => [label, () => done(value), look]), "small");
      this.closing = () => done(buttons.at(-1)[1]);
    });
  }

  close() {
    this.place.hidden = true;
    put(this.place);
    this.closed?.();
    this.closed = null;
  }
}
