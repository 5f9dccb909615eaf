/** Signing in, and back to where the reader wanted to go. */

import { post } from "../core/api.js";
import { byId } from "../core/dom.js";
import { busy, guarded } from "../core/notify.js";

/** Only a path of this server, never another host. */
function goal() {
  const next = new URL(new URLSearchParams(location.search).get("next") ?? "/", location.origin);
  return next.origin === location.origin ? next.pathname + next.search : "/";
}

byId("login").addEventListener("submit", (event) => {
  event.preventDefault();
  const { email, password } = event.target.elements;
  busy(event.submitter ?? password, () => guarded(async () => {
    await post("session", { email: email.value, password: password.value });
    location.assign(goal());
  }));
});
byId("email").focus();
