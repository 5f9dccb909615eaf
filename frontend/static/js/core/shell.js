/** What every page starts with: menus, and the number of running jobs on the rail. */

import { get } from "./api.js";
import { byId } from "./dom.js";
import { menus } from "./ui.js";

menus();

/** Show on the rail how many jobs are running or waiting; when that can't be told, nothing is shown. */
export async function countJobs() {
  const badge = byId("jobs-badge");
  const pages = await Promise.all(["running", "queued"].map((state) => get(`jobs?state=${state}&limit=50`))).catch(() => []);
  const count = pages.reduce((sum, page) => sum + page.items.length, 0);
  badge.hidden = count === 0;
  badge.textContent = count > 9 ? "9+" : String(count);
  badge.setAttribute("aria-label", `${count} running`);
}

/** Ask for the session; a page that can do without one shows nothing of it. */
export const session = () => get("session");
