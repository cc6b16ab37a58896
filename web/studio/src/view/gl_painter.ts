// The textured mesh on a canvas, with plain WebGL 2.
import type { Body } from "../model/puppet.js";
import { Ordered, cornersOf, endsOf } from "./scene.js";
import type { Colour, Painter, Scene } from "./scene.js";

const vertexShader = `#version 300 es
uniform vec4 view; // x, y of the middle; half extents
in vec2 place;
in vec2 texel;
out vec2 at;
void main() {
  at = texel;
  gl_Position = vec4((place - view.xy) / view.zw, 0.0, 1.0);
}`;
const fragmentShader = `#version 300 es
precision mediump float;
uniform sampler2D picture;
uniform vec4 tint;  // colour, and how much of it
uniform float strength;
in vec2 at;
out vec4 colour;
void main() {
  vec4 own = texture(picture, at); // premultiplied
  float alpha = mix(own.a, 1.0, step(1.5, tint.a));
  colour = vec4(mix(own.rgb, tint.rgb * alpha, min(tint.a, 1.0)), alpha) * strength;
}`;

export class GlPainter implements Painter {
  readonly isFast = true;
  readonly #canvas: HTMLCanvasElement;
  readonly #gl: WebGL2RenderingContext;
  readonly #program: WebGLProgram;
  readonly #places: WebGLBuffer;
  readonly #texels: WebGLBuffer;
  readonly #indices: WebGLBuffer;
  readonly #uniform: Record<"view" | "tint" | "strength", WebGLUniformLocation | null>;
  #texture: WebGLTexture | null = null;
  #body: Body | null = null;
  #size = { width: 1, height: 1 };
  #edges: Uint32Array = new Uint32Array(0);
  /** What the index buffer holds: mostly the same for all pictures of a drag. */
  #uploaded: Uint32Array | undefined;
  readonly #ordered = new Ordered();

  /** Throws where there is no WebGL 2. `keep` for canvases that are read from. */
  constructor(canvas: HTMLCanvasElement, keep = false) {
    const gl = canvas.getContext("webgl2", {
      alpha: true,
      premultipliedAlpha: true,
      preserveDrawingBuffer: keep,
      antialias: true,
    }) as WebGL2RenderingContext | null;
    if (!gl) throw new Error("no WebGL 2");
    this.#canvas = canvas;
    this.#gl = gl;
    this.#program = link(gl);
    const uniform = (name: string) => gl.getUniformLocation(this.#program, name);
    this.#uniform = { view: uniform("view"), tint: uniform("tint"), strength: uniform("strength") };
    this.#places = gl.createBuffer()!;
    this.#texels = gl.createBuffer()!;
    this.#indices = gl.createBuffer()!;
    gl.useProgram(this.#program);
    const bind = (name: string, buffer: WebGLBuffer): void => {
      const at = gl.getAttribLocation(this.#program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, 2, gl.FLOAT, false, 0, 0);
    };
    bind("place", this.#places);
    bind("texel", this.#texels);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.#indices);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  picture(image: HTMLCanvasElement): void {
    const gl = this.#gl;
    if (this.#texture) gl.deleteTexture(this.#texture);
    this.#texture = gl.createTexture();
    this.#size = { width: image.width, height: image.height };
    this.#body = null;
    gl.bindTexture(gl.TEXTURE_2D, this.#texture);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, true);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, image);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.generateMipmap(gl.TEXTURE_2D);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  }

  body(body: Body): void {
    if (body === this.#body) return;
    const picture = this.#body?.picture;
    this.#body = body;
    if (picture === body.picture) return;
    const texels = Float32Array.from(
      body.picture,
      (value, i) => value / (i % 2 === 0 ? this.#size.width : this.#size.height),
    );
    const gl = this.#gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#texels);
    gl.bufferData(gl.ARRAY_BUFFER, texels, gl.STATIC_DRAW);
    this.#edges = endsOf(body.triangles);
  }

  paint(scene: Scene, ratio: number): void {
    const gl = this.#gl;
    const { width, height } = this.#canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (!this.#body || !this.#texture) return;
    const { camera } = scene;
    const half = 2 * camera.zoom * ratio;
    gl.uniform4f(this.#uniform.view, camera.x, camera.y, width / half, height / half);
    const all = this.#ordered.of(this.#body.triangles, scene.order);
    for (const ghost of scene.ghosts) {
      this.#place(ghost.shape);
      this.#draw(all, [0, 0, 0], 0, ghost.strength);
    }
    this.#place(scene.shape);
    this.#draw(all, [0, 0, 0], 0, 1);
    for (const layer of scene.layers) {
      if (layer.triangles.length === 0) continue;
      const corners = cornersOf(this.#body.triangles, layer.triangles);
      this.#draw(corners, layer.tint, layer.part, layer.strength);
    }
    if (scene.wire) this.#draw(this.#edges, scene.wire, 2, 0.45, gl.LINES);
  }

  #place(shape: ArrayLike<number>): void {
    const gl = this.#gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#places);
    // A constructor copies, where `from` would go through an iterator.
    const places = shape instanceof Float32Array ? shape : new Float32Array(shape);
    gl.bufferData(gl.ARRAY_BUFFER, places, gl.STREAM_DRAW);
  }

  #draw(
    indices: Uint32Array,
    tint: Colour,
    part: number,
    strength: number,
    how: number = this.#gl.TRIANGLES,
  ): void {
    const gl = this.#gl;
    gl.uniform4f(this.#uniform.tint, ...tint, part);
    gl.uniform1f(this.#uniform.strength, strength);
    if (indices !== this.#uploaded) {
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
      this.#uploaded = indices;
    }
    gl.drawElements(how, indices.length, gl.UNSIGNED_INT, 0);
  }
}

function link(gl: WebGL2RenderingContext): WebGLProgram {
  const program = gl.createProgram()!;
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertexShader],
    [gl.FRAGMENT_SHADER, fragmentShader],
  ] as const) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error(gl.getProgramInfoLog(program) ?? "no shaders");
  }
  return program;
}
