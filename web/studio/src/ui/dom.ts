// Making elements, without a framework.

type Child = Node | string | null | undefined | false;
type Attributes = Record<string, unknown>;

/** An element. Attributes that start with "on" are listeners, false ones are left out. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) {
      element.addEventListener(name.slice(2), value as EventListener);
    } else if (value === true) {
      element.setAttribute(name, "");
    } else if (value !== false && value !== undefined && value !== null) {
      element.setAttribute(name, String(value));
    }
  }
  for (const child of children) if (child) element.append(child);
  return element;
}

/** Changes a text only where it is another one: each change costs the browser a layout. */
export function write(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
/** The same for an attribute. */
export function mark(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

let ids = 0;
export const freshName = (): string => `x${++ids}`;

export const button = (text: string, act: () => void, attributes: Attributes = {}) =>
  h("button", { type: "button", onclick: act, ...attributes }, text);

/** A field that shows the document and changes it. */
export interface Field {
  element: HTMLElement;
  /** Shows what is so now. */
  sync(): void;
}

export interface SliderOptions {
  label: string;
  min: number;
  max: number;
  step?: number | "any";
  get: () => number;
  /** While it moves; `done` when it has been let go. */
  set: (value: number, done: boolean) => void;
  say: (value: number) => string;
  disabled?: () => boolean;
}

export function slider(options: SliderOptions): Field {
  const id = freshName();
  const output = h("output", { for: id });
  const input = h("input", {
    id,
    type: "range",
    min: options.min,
    max: options.max,
    step: options.step ?? 1,
  });
  const show = (value: number): void => {
    const text = options.say(value);
    write(output, text);
    mark(input, "aria-valuetext", text);
  };
  input.addEventListener("input", () => {
    show(input.valueAsNumber);
    options.set(input.valueAsNumber, false);
  });
  input.addEventListener("change", () => options.set(input.valueAsNumber, true));
  const element = h(
    "div",
    { class: "field" },
    h("label", { for: id }, options.label),
    output,
    input,
  );
  return {
    element,
    sync() {
      input.disabled = options.disabled?.() ?? false;
      const value = options.get();
      if (input.valueAsNumber !== value) input.value = String(value);
      show(value);
    },
  };
}

export function choice<T extends string>(options: {
  label: string;
  values: Record<T, string>;
  get: () => T;
  set: (value: T) => void;
  disabled?: () => boolean;
}): Field {
  const id = freshName();
  const entries = Object.entries(options.values) as [T, string][];
  const select = h(
    "select",
    { id, onchange: () => options.set(select.value as T) },
    ...entries.map(([value, text]) => h("option", { value }, text)),
  );
  return {
    element: h("div", { class: "field choice" }, h("label", { for: id }, options.label), select),
    sync() {
      select.disabled = options.disabled?.() ?? false;
      select.value = options.get();
    },
  };
}

export function check(options: {
  label: string;
  get: () => boolean;
  set: (value: boolean) => void;
  disabled?: () => boolean;
}): Field {
  const input = h("input", { type: "checkbox", onchange: () => options.set(input.checked) });
  return {
    element: h("label", { class: "check" }, input, h("span", {}, options.label)),
    sync() {
      input.disabled = options.disabled?.() ?? false;
      input.checked = options.get();
    },
  };
}

/** A number that is typed. What is no number from `min` to `max` is not taken, and said by the browser. */
export function amount(options: {
  label: string;
  unit: string;
  min: number;
  max: number;
  get: () => number;
  set: (value: number) => void;
}): Field {
  const id = freshName();
  const input = h("input", {
    id,
    type: "number",
    inputmode: "decimal",
    min: options.min,
    max: options.max,
    step: "any",
    onchange: () => {
      if (input.reportValidity() && input.value !== "") options.set(input.valueAsNumber);
    },
  });
  return {
    element: h(
      "div",
      { class: "field amount" },
      h("label", { for: id }, options.label),
      h("span", {}, input, ` ${options.unit}`),
    ),
    sync() {
      if (document.activeElement !== input) input.value = String(options.get());
    },
  };
}

/** A button that lets the visitor choose a file. */
export function fileButton(
  text: string,
  accept: string,
  open: (file: File) => void,
): HTMLElement[] {
  const input = h("input", {
    type: "file",
    accept,
    class: "unseen",
    id: freshName(),
    tabindex: -1,
    "aria-hidden": "true",
    onchange: () => {
      const file = input.files?.[0];
      input.value = "";
      if (file) open(file);
    },
  });
  return [button(text, () => input.click(), { class: "main" }), input];
}

/** Saves bytes under a name, as the browser does it. */
export function download(name: string, parts: BlobPart[], type: string): void {
  const address = URL.createObjectURL(new Blob(parts, { type }));
  const link = h("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}
