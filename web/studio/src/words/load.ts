// Every text of the load page.

const round = (value: number): string => String(Math.round(value));

// Three digits that count.
function digits(value: number): string {
  if (value === 0) return "0";
  return value >= 100 ? round(value) : String(Number(value.toPrecision(value < 0.1 ? 1 : 2)));
}

export const load = {
  skip: "To the charts",
  pause: "Pause",
  goOn: "Go on",
  span: "Show",
  spans: { "2": "the last 2 minutes", "10": "the last 10 minutes" },
  moment: "Moment",
  now: "now",
  ago: (seconds: number) => (seconds < 1 ? "now" : `${round(seconds)} s ago`),
  axis: (minutes: number) => `−${minutes} min`,
  states: {
    starting: "Asking the gateway…",
    live: "Live",
    paused: "Paused",
    lost: "The gateway does not answer. Trying again…",
    hidden: "The gateway does not show its load here.",
  },
  hiddenHint: (command: string) =>
    `Load is for operators. Start the gateway with ${command}, where arapd says its admin page is, and open this page on the machine where the gateway runs; --metrics all shows it to everybody.`,
  facts: (version: string, up: string, gatewayUp: string) =>
    `arapd ${version}, up for ${up}; gateway up for ${gatewayUp}`,
  weakness: (reasons: string) => `The store is not as it should be: ${reasons}.`,
  duration: (seconds: number) =>
    seconds < 120
      ? `${round(seconds)} s`
      : seconds < 7200
        ? `${round(seconds / 60)} min`
        : seconds < 172_800
          ? `${round(seconds / 3600)} h`
          : `${round(seconds / 86_400)} days`,
  charts: {
    shapes: "Shapes",
    shapeTime: "Computing a shape",
    queueTime: "Waiting for a worker, live",
    waiting: "Jobs that wait",
    busy: "Workers that are busy",
    open: "Open now",
    requests: "Requests to the gateway",
    requestTime: "Answering a request",
    memory: "Memory",
    processor: "Processors in use",
  } as Record<string, string>,
  lines: {
    computed: "computed",
    sent: "sent to pages",
    replaced: "replaced by newer ones",
    median: "median",
    p99: "99 of 100 within",
    interactive: "live",
    control: "meshes and pins",
    jobs: "flattening",
    sessions: "sessions",
    streams: "streams",
    sockets: "sockets",
    answered: "answered",
    refused: "refused",
    failed: "failed",
    server: "arapd",
    accounted: "arapd, what is kept",
    gateway: "gateway",
  } as Record<string, string>,
  chart: (title: string, lines: string) => `${title}: ${lines}`,
  line: (name: string, value: string) => `${name} ${value}`,
  table: "In numbers",
  columns: ["What", "Mean", "Highest"] as const,
  refused: "Refused since this page was opened",
  refusedColumns: ["Reason", "By", "How often"] as const,
  refusedNone: "Nothing.",
  by: { server: "arapd", gateway: "gateway" },
  nothing: "–",
  units: {
    rate: (value: number) => `${digits(value)}/s`,
    ms: (value: number) => `${digits(value)} ms`,
    count: (value: number) => digits(value),
    bytes: (value: number) =>
      value < 2 ** 30 ? `${digits(value / 2 ** 20)} MiB` : `${digits(value / 2 ** 30)} GiB`,
    part: (value: number) => `${round(100 * value)} %`,
    cores: (value: number) => digits(value),
  },
};
