// What a page must not have; evaluates to a list of sentences, empty when all is well.
() => {
  const all = (selector) => [...document.querySelectorAll(selector)].filter((node) => !node.closest(".js-plotly-plot"));
  const shown = (node) => node.checkVisibility({ visibilityProperty: true });
  const words = (node) => (node?.getAttribute("aria-label") || node?.innerText || node?.title || "").trim();
  const byIds = (node, name) => (node.getAttribute(name) ?? "").split(" ").filter(Boolean);
  const named = (node) => words(node) || [...(node.labels ?? [])].some(words)
    || byIds(node, "aria-labelledby").some((id) => words(document.getElementById(id)));

  const faults = [];
  for (const node of all("a[href], button, input, select, textarea, summary, [role=tab], [role=img], dialog[open]")) {
    if (shown(node) && !named(node)) faults.push(`without a name: ${node.outerHTML.slice(0, 160)}`);
  }
  const ids = all("[id]").map((node) => node.id);
  faults.push(...ids.filter((id, i) => ids.indexOf(id) !== i).map((id) => `two elements have the id ${id}`));
  for (const name of ["aria-describedby", "aria-controls", "aria-errormessage", "aria-labelledby"]) {
    for (const node of all(`[${name}]`)) {
      for (const id of byIds(node, name)) if (!document.getElementById(id)) faults.push(`#${id} is referred to and not there`);
    }
  }
  const levels = all("h1, h2, h3").filter(shown).map((node) => Number(node.tagName[1]));
  if (levels.filter((level) => level === 1).length !== 1) faults.push("not exactly one h1");
  levels.forEach((level, i) => {
    if (i > 0 && level > levels[i - 1] + 1) faults.push(`a heading jumps to level ${level}`);
  });
  for (const cell of all("th")) if (!cell.scope) faults.push(`a header cell without scope: ${cell.innerText}`);
  if (all("[tabindex]").some((node) => node.tabIndex > 0)) faults.push("a tabindex above 0");
  return faults;
}
