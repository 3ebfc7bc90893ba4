// A sheet over the page with a question or a form. It isn't modal, so the STOP button and the status bar stay usable.

import { button, h, put } from "/dom.js";

export class Sheet {
  constructor(place) {
    this.place = h("section", { class: "sheet", role: "dialog", hidden: true, tabindex: -1 });
    place.append(this.place);
  }

  // Show content and buttons [label, action, class]. A button first closes the sheet, then calls its action.
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

  // Ask a question with several answers. If the sheet is closed without an answer, the last one counts.
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
