// A session with a sheet of triangles and two handles on it, and a surface that takes long to flatten.
import { farthest, grid } from "../../../client/test/support/meshes.js";
import { json } from "./gateway.js";
import { Page } from "./page.js";

export { farthest, grid };
export const plain = (mesh: { vertices: Float64Array; triangles: Uint32Array }) => ({
  vertices: Array.from(mesh.vertices),
  triangles: Array.from(mesh.triangles),
});

/** To flatten this takes ten seconds and more, unless somebody ends it: spikes that no layout agrees with. */
export const long = {
  mesh: plain(grid(300, 300, (x, y) => Math.sin(x / 12) * Math.cos(y / 10) * 300)),
  refine: 1000,
  refineStop: 0,
  injective: true,
};

/** The id of a session with the mesh m of columns × columns vertices and the set h of l and r. */
export async function puppet(
  url: string,
  columns = 9,
  headers: Record<string, string> = {},
): Promise<string> {
  const session = (await json(`${url}/v1/sessions`, { body: {}, headers }, 201)) as { id: string };
  const at = `${url}/v1/sessions/${session.id}`;
  await json(
    `${at}/meshes`,
    { body: { id: "m", mesh: plain(grid(columns, columns)) }, headers },
    201,
  );
  const handles = [
    { id: "l", vertex: 0 },
    { id: "r", vertex: columns - 1 },
  ];
  await json(`${at}/handle-sets`, { body: { id: "h", meshId: "m", handles }, headers }, 201);
  return session.id;
}

/** A page with an open stream on it. */
export async function drag(url: string, session: string, open: object = {}): Promise<Page> {
  const page = await Page.connect(url, session);
  page.say({ type: "open", handleSet: "h", ...open });
  await page.text("opened");
  return page;
}
export const move = (x: number, y: number) => ({ type: "update", targets: [{ id: "r", x, y }] });
