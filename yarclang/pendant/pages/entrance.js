// The login page. With the token of the one-time link, it creates the first user.

import { post } from "/api.js";
import { h, put } from "/dom.js";

export function entrance(place, { first, token, said }, open) {
  const told = h("p", { role: "alert", class: "told" }, said);
  const making = first && token;
  const field = (label, attributes) => h("label", {}, label, h("input", { required: true, ...attributes }));
  const user = field("Name", { name: "user", autocomplete: "username", autocapitalize: "none", maxlength: 40 });
  const password = field(making ? "Password (at least 8 characters)" : "Password", {
    name: "password",
    type: "password",
    autocomplete: making ? "new-password" : "current-password",
    minlength: making ? 8 : null,
  });
  const pin = making && field("PIN for service work (4 to 12 digits)", { name: "pin", type: "password", inputmode: "numeric", pattern: "[0-9]{4,12}", autocomplete: "off" });
  const enter = h("button", { type: "submit", class: "main" }, making ? "Make the first user" : "Log in");
  const form = h(
    "form",
    {
      onsubmit: async (event) => {
        event.preventDefault();
        enter.disabled = true;
        const given = Object.fromEntries(new FormData(form));
        try {
          open(await post(making ? "/api/first" : "/api/login", making ? { token, ...given } : given));
        } catch (refused) {
          told.textContent = refused.message;
        } finally {
          enter.disabled = false;
        }
      },
    },
    h("h1", {}, "TCPad"),
    making && h("p", {}, "There is no user yet. The first user gets the role service, and creates the others."),
    first && !token && h("p", {}, "There is no user yet: open the link that `yarc pendant` has printed."),
    user,
    password,
    pin,
    enter,
    told,
  );
  put(place, form);
  form.querySelector("input").focus();
}
