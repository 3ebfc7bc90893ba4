// Questions in dialogs.

import { button, h } from "/dom.js";

// Ask the user for a name, and call `act` with it. If `act` fails, the dialog shows the error and stays open.
export function askName(title, value, label, act) {
  const input = h("input", { type: "text", name: "path", value, autocomplete: "off", spellcheck: "false", maxlength: 1000, "aria-label": title });
  const told = h("p", { class: "told", role: "alert" });
  const form = h("form", {
    onsubmit: async (event) => {
      event.preventDefault();
      try {
        await act(input.value.trim());
        dialog.close();
      } catch (refused) {
        told.textContent = refused.message;
      }
    },
  }, h("h2", {}, title), input, told, h("div", { class: "actions" }, h("button", { type: "submit", class: "main" }, label), button("Cancel", () => dialog.close())));
  const dialog = opened(form, "asks");
  input.focus();
  const from = value.lastIndexOf("/") + 1;
  const dot = value.lastIndexOf(".");
  input.setSelectionRange(from, dot > from ? dot : value.length);
  return dialog;
}

// Open a dialog over the page. It isn't modal, so the STOP button stays usable.
export function opened(content, kind, closed = () => {}) {
  const page = document.getElementById("page");
  for (const other of page.querySelectorAll("dialog")) other.close();
  const dialog = h("dialog", { class: kind, onclose: () => { closed(); dialog.remove(); } }, content);
  page.append(dialog);
  dialog.show();
  return dialog;
}
