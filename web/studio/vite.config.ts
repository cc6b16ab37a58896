import { readdirSync } from "node:fs";
import { defineConfig } from "vite";

// Every HTML file here is a page. Everything is asked for relative to it, so that it can be served under any
// path.
export default defineConfig({
  base: "./",
  build: {
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 700, // kB: three.js, which only the flatten page loads
    rollupOptions: { input: readdirSync(".").filter((name) => name.endsWith(".html")) },
  },
});
