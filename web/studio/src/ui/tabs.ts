// The panel: tabs, and what tabs are made of.
import { words } from "../words.js";
import { freshName, h } from "./dom.js";
import type { Field } from "./dom.js";

export interface Tab<Name extends string = string> {
  name: Name;
  element: HTMLElement;
  sync(): void;
}

/** Tabs as the ARIA pattern has them: arrow keys go from one to the next. */
export function tabbed<Name extends string>(
  tabs: readonly Tab<Name>[],
  names: Record<Name, string>,
): { element: HTMLElement; show(name: Name): void } {
  const buttons = tabs.map((tab) => {
    const panel = freshName();
    tab.element.id = panel;
    tab.element.setAttribute("role", "tabpanel");
    tab.element.tabIndex = 0;
    const id = freshName();
    tab.element.setAttribute("aria-labelledby", id);
    return h(
      "button",
      { type: "button", role: "tab", id, "aria-controls": panel, onclick: () => show(tab.name) },
      names[tab.name],
    );
  });
  const list = h("div", { role: "tablist", "aria-label": words.tabList }, ...buttons);
  list.addEventListener("keydown", (event) => {
    const at = buttons.indexOf(event.target as HTMLButtonElement);
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (at < 0 || step === undefined) return;
    const next = (at + step + tabs.length) % tabs.length;
    show(tabs[next].name);
    buttons[next].focus();
    event.preventDefault();
  });
  function show(name: Name): void {
    tabs.forEach((tab, i) => {
      const isShown = tab.name === name;
      tab.element.hidden = !isShown;
      buttons[i].setAttribute("aria-selected", String(isShown));
      buttons[i].tabIndex = isShown ? 0 : -1;
      if (isShown) tab.sync();
    });
  }
  show(tabs[0].name);
  return { element: h("div", { class: "panel" }, list, ...tabs.map((tab) => tab.element)), show };
}

export const section = (title: string, ...children: (HTMLElement | null)[]): HTMLElement =>
  h("section", {}, h("h2", {}, title), ...children);

export const fieldsOf = (fields: readonly Field[]) => ({
  elements: fields.map((field) => field.element),
  sync: () => fields.forEach((field) => field.sync()),
});
