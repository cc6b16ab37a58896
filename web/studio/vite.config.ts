import { defineConfig } from "vite";

// Everything is asked for relative to the page, so that it can be served under any path.
export default defineConfig({
  base: "./",
  build: { target: "es2022", assetsInlineLimit: 0, modulePreload: { polyfill: false } },
});
