import { readdirSync } from "node:fs";
import { defineConfig } from "vite";
import type { HtmlTagDescriptor } from "vite";

const icon =
  "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'>" +
  "<circle cx='8' cy='8' r='7' fill='#0b6e5f'/><circle cx='8' cy='8' r='3' fill='#fff'/></svg>";

/** What the head of every page has besides its title and description. */
const head: HtmlTagDescriptor[] = [
  { tag: "meta", attrs: { charset: "utf-8" } },
  { tag: "meta", attrs: { name: "viewport", content: "width=device-width, initial-scale=1" } },
  { tag: "meta", attrs: { name: "color-scheme", content: "light dark" } },
  {
    tag: "link",
    attrs: { rel: "icon", href: `data:image/svg+xml,${encodeURIComponent(icon)}` },
    injectTo: "head",
  },
];

// Every HTML file here is a page. Everything is asked for relative to it, so that it can be served under any
// path.
export default defineConfig({
  base: "./",
  plugins: [{ name: "head", transformIndexHtml: () => head }],
  build: {
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 700, // kB: three.js, which only the flatten page loads
    rollupOptions: { input: readdirSync(".").filter((name) => name.endsWith(".html")) },
  },
});
