// The flatten page, with words for what a visitor does.
import { readFileSync } from "node:fs";

import type { BrowserContextOptions } from "playwright-core";

import type { Stack } from "./stack.js";
import { Visit } from "./stack.js";

export class Patterns extends Visit {
  /** Waits until the layout is that of the document, and the views show it. */
  async settle(): Promise<void> {
    await this.until("shop.isSettled");
    await this.ask(
      "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(null))))",
    );
  }

  async upload(name: string, content: string | Buffer): Promise<void> {
    const buffer = Buffer.from(content);
    const input = this.page.locator("input[type=file]");
    await input.setInputFiles({ name, mimeType: "application/octet-stream", buffer });
  }
  /** Waits until the model of that name is laid flat. */
  async flat(name: string): Promise<void> {
    await this.until(`shop.surface?.name === ${JSON.stringify(name)}`);
    await this.settle();
  }

  async tool(name: string): Promise<void> {
    const tools = this.page.getByRole("group", { name: "Tool" });
    await tools.getByRole("button", { name, exact: true }).click();
  }

  /** Where a vertex is in a view; a little towards another, so that the surface is hit. */
  async at(view: string, vertex: number, towards: number): Promise<[number, number]> {
    const [[x, y], [tx, ty]] = await this.ask<[number, number][]>(
      `[${view}.inWindow(${vertex}), ${view}.inWindow(${towards})]`,
    );
    return [x + 0.2 * (tx - x), y + 0.2 * (ty - y)];
  }
  async click(view: string, vertex: number, towards: number): Promise<void> {
    await this.page.mouse.click(...(await this.at(view, vertex, towards)));
  }

  async save(kind: string): Promise<{ name: string; bytes: Buffer }> {
    await this.tab("Save");
    const coming = this.page.waitForEvent("download");
    await this.page.locator(`[data-save=${kind}]`).click();
    const download = await coming;
    return { name: download.suggestedFilename(), bytes: readFileSync((await download.path())!) };
  }
}

/** The page with the first sample laid flat, and the model drawn unless `before` prevents it. */
export async function openPatterns(
  stack: Stack,
  options: BrowserContextOptions = {},
  before = "",
  search = "",
): Promise<Patterns> {
  const [page, faults] = await stack.watched(options, `flatten.html${search}`, before);
  const patterns = new Patterns(page, faults);
  await patterns.until("document.querySelector('#model') !== null");
  await patterns.settle();
  return patterns;
}
