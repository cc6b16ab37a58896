// Who paints the figure: WebGL where a graphics processor draws, else the page itself.
import { GlPainter } from "./gl_painter.js";
import type { Painter } from "./scene.js";
import { SoftPainter } from "./soft_painter.js";

/** `keep` for canvases that are read from. */
export function painterOf(canvas: HTMLCanvasElement, keep = false): Painter {
  if (hasGraphics()) {
    try {
      return new GlPainter(canvas, keep);
    } catch {
      // There may be few of them at a time. A canvas that has no context yet takes another.
    }
  }
  return new SoftPainter(canvas);
}

let known: boolean | undefined;

/** Whether a graphics processor draws: what the address of the page says (?draw=webgl, ?draw=page), or WebGL. */
export function hasGraphics(): boolean {
  known ??= (() => {
    const said = new URLSearchParams(location.search).get("draw");
    if (said === "webgl" || said === "page") return said === "webgl";
    const asked = { failIfMajorPerformanceCaveat: true };
    const canvas = document.createElement("canvas");
    const gl = canvas.getContext("webgl2", asked) as WebGL2RenderingContext | null;
    if (!gl) return false;
    // Browsers say it, or by which name they draw themselves.
    const facts = gl.getExtension("WEBGL_debug_renderer_info");
    const name = String(gl.getParameter(facts?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
    gl.getExtension("WEBGL_lose_context")?.loseContext();
    return !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  })();
  return known;
}
