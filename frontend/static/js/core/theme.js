/** Light, dark, or as the system has it. `theme-early.js` applies the choice before the first paint. */

const KEY = "ponthy-theme";
const system = matchMedia("(prefers-color-scheme: dark)");
const listeners = new Set();
const tell = () => listeners.forEach((listener) => listener(currentTheme()));

/** "light" or "dark", as the page looks now. */
export const currentTheme = () => document.documentElement.dataset.theme || (system.matches ? "dark" : "light");

/** "light", "dark" or "system". */
export const chosenTheme = () => document.documentElement.dataset.theme || "system";

/** Choose a theme; kept in this browser. */
export function chooseTheme(theme) {
  if (theme === "system") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  try {
    if (theme === "system") localStorage.removeItem(KEY);
    else localStorage.setItem(KEY, theme);
  } catch {
    // Storage is blocked: the choice holds for this page only.
  }
  tell();
}

/** Call back whenever the look changes. */
export function onTheme(listener) {
  listeners.add(listener);
}

system.addEventListener("change", tell);
