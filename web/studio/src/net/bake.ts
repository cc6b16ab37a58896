// All shapes of a take, in order: a stream that leaves no frame out.
import { pinsAt, playedFrames } from "../model/take.js";
import type { Take } from "../model/take.js";
import { orderOf } from "../view/order.js";
import { Problem } from "./api.js";
import type { Session } from "./session.js";
import { Socket } from "./socket.js";

export interface Film {
  take: Take;
  /** As they are played: trimmed, smoothed, looped. */
  frames: Float64Array[];
  /** x y x y… per frame. */
  shapes: Float32Array[];
  /** Triangles back to front. */
  order: ArrayLike<number>;
  /** How far a coordinate may be off from what the server has computed. */
  error: number;
}

/** So many updates are on their way at most. */
const ahead = 8;

/** Rejects with a Problem; CANCELLED when the signal says so. */
export async function bake(
  session: Session,
  take: Take,
  signal: AbortSignal,
  progress: (part: number) => void,
): Promise<Film> {
  const frames = playedFrames(take);
  const mesh = await session.mesh(take);
  const set = await session.handleSet(mesh, take.pins);
  const id = await session.id();
  let socket: Socket | undefined;
  const deep = set.drawOrder ?? [];
  const order = deep.length > 0 ? deep : orderOf(take.body.triangles);
  const film: Film = { take, frames, shapes: [], order, error: 0 };
  try {
    return await new Promise<Film>((resolve, reject) => {
      let sent = 0;
      const cancel = (): void => reject(new Problem(0, "CANCELLED", ""));
      const say = (): void => {
        while (sent < frames.length && sent < film.shapes.length + ahead) {
          if (socket!.say(pinsAt(take.pins, frames[sent]), true) === undefined) return;
          ++sent;
        }
      };
      if (signal.aborted) return cancel();
      signal.addEventListener("abort", cancel);
      const events = {
        opened: say,
        shape: ({
          positions,
          facts,
        }: {
          positions: Float64Array;
          facts: { positionError: number };
        }) => {
          const most = positions.reduce((max, value) => Math.max(max, Math.abs(value)), 0);
          // Rounding to float32, which takes half the room, is part of the error.
          film.error = Math.max(film.error, facts.positionError + most * 2 ** -24);
          film.shapes.push(Float32Array.from(positions));
          progress(film.shapes.length / frames.length);
          if (film.shapes.length === frames.length) resolve(film);
          else say();
        },
        refused: reject,
        resumed: () => {},
        draining: () => {},
        closed: reject,
      };
      socket = new Socket(id, set.id, take.motion, "every", events, take.pins);
    });
  } finally {
    socket?.close();
    void session.dropHandleSet(set.id);
  }
}
