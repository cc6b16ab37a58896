// Client of arapd. The README has an example; every type says its units, lengths and defaults.
export { Client } from "./client.js";
export type { Limits, ServerInfo, SessionOptions, SessionPage } from "./client.js";
export type { CallOptions } from "./calls.js";
export type { ConnectOptions } from "./channel.js";
export { ArapError, reasons } from "./errors.js";
export type { Code, Reason } from "./errors.js";
export type { Drawing, DrawingFile, DrawingOptions, NamedPart } from "./drawing.js";
export { hasEnded } from "./jobs.js";
export type { FlattenJob, JobState } from "./jobs.js";
export type {
  Distortion,
  FlatChart,
  FlatSurface,
  FlattenOptions,
  GrainLine,
  RefineEnd,
  UvPin,
} from "./flatten.js";
export type {
  Anchor,
  Compilation,
  Handle,
  HandleSetInfo,
  HandleTarget,
  PlacedHandle,
  Point,
} from "./handles.js";
export type {
  Basis,
  EdgeWeights,
  EnergyOptions,
  MeshInfo,
  OutlineMesh,
  OutlineOptions,
  PlanarMesh,
  Registration,
  RepairOptions,
  SurfaceMesh,
  Warning,
} from "./mesh.js";
export type { PositionOptions, Positions } from "./positions.js";
export type { Indices, Numbers } from "./runs.js";
export { Session } from "./session.js";
export type { RegisterOptions, SessionInfo } from "./session.js";
export type { Pick, Shape, ShapeOptions } from "./shape.js";
export { DeformStream } from "./stream/deform_stream.js";
export type { HandleEdit, HandleUpdate, StreamEvent, StreamOptions } from "./stream/options.js";
export type { TrackFrame } from "./track.js";
