// What schemas are made of.
import { Type } from "@sinclair/typebox";
import type { TObject, TProperties, TSchema } from "@sinclair/typebox";

/** An object that knows its properties and refuses others. */
export const closed = <T extends TProperties>(properties: T, more: object = {}): TObject<T> =>
  Type.Object(properties, { additionalProperties: false, ...more });

/** One of these texts. */
export const oneOf = <const T extends readonly string[]>(values: T, description?: string) =>
  Type.Unsafe<T[number]>({
    type: "string",
    enum: [...values],
    ...(description && { description }),
  });

export const numbers = (description: string) => Type.Array(Type.Number(), { description });
export const indices = (description: string) =>
  Type.Array(Type.Integer({ minimum: 0, maximum: 4294967295 }), { description });
export const index = (description?: string) =>
  Type.Integer({ minimum: 0, maximum: 4294967295, ...(description && { description }) });
/** An id that arapd takes; it is the one to say what is wrong with another. */
export const name = (description?: string) =>
  Type.String({ maxLength: 1000, ...(description && { description }) });
export const optional = Type.Optional;
export const flag = (description: string) => Type.Optional(Type.Boolean({ description }));

/** What a path holds. */
export const parameters = <const T extends readonly string[]>(...names: T) =>
  Type.Object(
    Object.fromEntries(names.map((one) => [one, Type.String()])) as Record<
      T[number],
      ReturnType<typeof Type.String>
    >,
  );

/** The same for all routes: what can go wrong. */
export const Problem = Type.Object(
  {
    type: Type.String({ description: "Leads to what the reason means." }),
    title: Type.String(),
    status: Type.Integer(),
    detail: Type.String({ description: "What is wrong, in a sentence." }),
    reason: Type.String({ description: "As in docs/web.md." }),
    field: optional(Type.String({ description: "A path in the request: handles[3].weight." })),
    elements: optional(indices("Vertices, triangles or handles at fault, counted from 0.")),
    details: optional(Type.Record(Type.String(), Type.String())),
    retryAfterMs: optional(Type.Integer({ description: "In how long trying again helps." })),
    requestId: optional(Type.String()),
  },
  { $id: "Problem", description: "RFC 9457" },
);

/** The answers of a route: those that go well, and every problem. */
export const answers = (good: Record<string, TSchema | object>) => ({
  ...good,
  default: {
    description: "A problem.",
    content: { "application/problem+json": { schema: Type.Ref("Problem") } },
  },
});

export const Warning = Type.Object(
  {
    kind: Type.String(),
    count: Type.Number(),
    elements: indices("The first few."),
    message: Type.String(),
  },
  { description: "Something that was repaired, ignored or doubted; never an error." },
);
