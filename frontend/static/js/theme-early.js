// Runs before the first paint, so that a chosen theme never flashes: a classic script in the head, not a module.
(() => {
  try {
    const theme = localStorage.getItem("ponthy-theme");
    if (theme === "light" || theme === "dark") document.documentElement.dataset.theme = theme;
  } catch {
    // Storage is blocked in this browser: the system's theme is used.
  }
})();
