// The gateway: REST and WebSocket in front of arapd. docs/web.md is its contract.
export {};
