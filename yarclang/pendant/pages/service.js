// Service work: what needs the role service asks for the PIN as well. STOP stays within reach meanwhile.

import { post } from "/api.js";
import { button, h } from "/dom.js";

// Do service work; the PIN is asked for where it is needed.
export async function serviced(app, work) {
  try {
    return await work();
  } catch (refused) {
    if (refused.code !== "pin") {
      app.notice(refused.message, true);
      return null;
    }
  }
  if (!(await askPin(app))) return null;
  return app.tried(work);
}

// The same for who deals with refusals: they are thrown, that of the PIN too if nobody enters it.
export async function pinned(app, work) {
  try {
    return await work();
  } catch (refused) {
    if (refused.code !== "pin" || !(await askPin(app))) throw refused;
  }
  return work();
}

// Ask for the PIN: true if it was right. A question that is open already is answered with no.
export function askPin(app) {
  document.querySelector("dialog.pin")?.close();
  return new Promise((done) => {
    const pin = h("input", { type: "password", inputmode: "numeric", autocomplete: "off", required: true, "aria-label": "PIN" });
    const told = h("p", { role: "alert" });
    const form = h("form", {
      onsubmit: async (event) => {
        event.preventDefault();
        try {
          await post("/api/pin", { pin: pin.value });
          dialog.close("yes");
        } catch (refused) {
          told.textContent = refused.message;
          pin.value = "";
        }
      },
    }, h("h2", {}, "Your PIN, please"), pin, told, h("div", { class: "actions" }, h("button", { type: "submit", class: "main" }, "Go on"), button("Cancel", () => dialog.close())));
    const dialog = h("dialog", { class: "asks pin", onclose: () => { done(dialog.returnValue === "yes"); dialog.remove(); } }, form);
    document.body.append(dialog);
    dialog.show();
    pin.focus();
  });
}
