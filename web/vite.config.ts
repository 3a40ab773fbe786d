import { defineConfig } from "vite";

const server = "http://127.0.0.1:8000";

export default defineConfig({
  base: "./",
  build: {
    outDir: "../server/console",
    emptyOutDir: true,
    target: "es2022",
    chunkSizeWarningLimit: 900,
    rollupOptions: { input: ["index.html", "motion.html"] },
  },
  // `npm run dev` shows the sources against a running `teleop serve`.
  // The server takes commands from its own origin only, so the proxy speaks in its name.
  server: { proxy: { "/api": { target: server, ws: true, headers: { origin: server } } } },
});
