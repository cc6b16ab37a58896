// The gateway: REST and WebSocket in front of arapd. docs/web.md is its contract.
export { createGateway } from "./gateway.js";
export type { Gateway } from "./gateway.js";
export { gateway } from "./plugin.js";
export { numberRules } from "./options.js";
export type { GatewayOptions, Numbers } from "./options.js";
export { kinds } from "./problems.js";
export type { OwnReason, ProblemDetails, ProblemReason } from "./problems.js";
