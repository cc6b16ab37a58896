// Light, dark, or as the system has it. The browser remembers.
import { words } from "../words.js";
import { choice } from "./dom.js";
import type { Field } from "./dom.js";

const memory = "arapd-studio-theme";
type Theme = "auto" | "light" | "dark";

function remembered(): Theme {
  try {
    const theme = localStorage.getItem(memory);
    return theme === "light" || theme === "dark" ? theme : "auto";
  } catch {
    return "auto";
  }
}

export function themeField(): Field {
  let theme = remembered();
  document.documentElement.dataset["theme"] = theme;
  const { label, auto, light, dark } = words.theme;
  return choice<Theme>({
    label,
    values: { auto, light, dark },
    get: () => theme,
    set: (chosen) => {
      theme = chosen;
      document.documentElement.dataset["theme"] = theme;
      try {
        localStorage.setItem(memory, theme);
      } catch {
        // Then it is for this visit.
      }
    },
  });
}
