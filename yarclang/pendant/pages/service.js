// Service work: orders that need the service role and the PIN. The STOP button stays usable while the PIN is entered.

import { post } from "/api.js";
import { button, h } from "/dom.js";

// Carry out service work. If it needs the PIN, ask for the PIN and carry it out again.
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

// Like `serviced`, but throw refusals to the caller. If nobody enters the PIN, the refusal for the missing PIN is
// thrown, too.
export async function pinned(app, work) {
  try {
    return await work();
  } catch (refused) {
    if (refused.code !== "pin" || !(await askPin(app))) throw refused;
  }
  return work();
}

// Ask for the PIN. Return true if it is correct. An open question for the PIN is closed, and counts as not answered.
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
