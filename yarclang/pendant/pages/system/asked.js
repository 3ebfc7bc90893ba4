// A question over the page, not modal: STOP stays within reach.

import { button, h } from "/dom.js";

// True if the person wants it.
export function asked(place, title, content, yes) {
  return new Promise((done) => {
    const no = button("Cancel", () => dialog.close());
    for (const other of place.querySelectorAll("dialog")) other.close();
    const dialog = h("dialog", { class: "asks", onclose: () => { done(dialog.returnValue === "yes"); dialog.remove(); } },
      h("h2", {}, title), content,
      h("div", { class: "actions" }, button(yes, () => dialog.close("yes"), { class: "main" }), no));
    place.append(dialog);
    dialog.show();
    no.focus();
  });
}
