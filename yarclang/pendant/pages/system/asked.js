// A question over the page. It isn't modal, so the STOP button stays usable.

import { button, h } from "/dom.js";

// Ask a question. Return true if the user agrees.
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
