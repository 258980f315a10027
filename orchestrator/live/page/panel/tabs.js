// Tabs, as the ARIA practices describe them: arrows go from one to the next.

export function bindTabs(list, onChange) {
  const tabs = [...list.querySelectorAll("[role=tab]")];
  const panelOf = (tab) => document.getElementById(tab.getAttribute("aria-controls"));
  const choose = (chosen) => {
    for (const tab of tabs) {
      tab.setAttribute("aria-selected", tab === chosen);
      tab.tabIndex = tab === chosen ? 0 : -1;
      panelOf(tab).hidden = tab !== chosen;
    }
    onChange();
  };
  list.addEventListener("click", ({target}) => target.closest("[role=tab]") && choose(target.closest("[role=tab]")));
  list.addEventListener("keydown", ({key}) => {
    const there = tabs.filter(({hidden}) => !hidden);
    const by = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0, at = there.indexOf(document.activeElement);
    if (!by || at < 0) return;
    const next = there[(at + by + there.length) % there.length];
    next.focus();
    choose(next);
  });
}
