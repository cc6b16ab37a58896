// The text format of Prometheus, as far as arapd and the gateway write it.

export interface Sample {
  labels: Readonly<Record<string, string>>;
  value: number;
}

/** How long things took: how many were at most so long, and longer than the bound before. */
export interface Times {
  /** Upper bounds in seconds, ascending. */
  bounds: number[];
  /** One more than there are bounds: the last ones were longer than all of them. */
  counts: number[];
  sum: number;
  count: number;
}

const line = /^([A-Za-z_:][\w:]*)(?:\{(.*)\})? (\S+)/;
const label = /([A-Za-z_]\w*)="((?:[^"\\]|\\.)*)"/g;

/** Metrics by their names. Lines that are none are passed over. */
export class Metrics {
  readonly #samples = new Map<string, Sample[]>();

  constructor(text: string) {
    for (const one of text.split("\n")) {
      const found = one.startsWith("#") ? null : line.exec(one);
      if (!found) continue;
      const [, name = "", labels = "", value = ""] = found;
      const sample = { labels: labelsOf(labels), value: Number(value) };
      if (!Number.isFinite(sample.value)) continue;
      const others = this.#samples.get(name);
      if (others) others.push(sample);
      else this.#samples.set(name, [sample]);
    }
  }

  all(name: string): readonly Sample[] {
    return this.#samples.get(name) ?? [];
  }
  /** The one number, or the sum of all that have the name; 0 where there is none. */
  total(name: string): number {
    return this.all(name).reduce((sum, { value }) => sum + value, 0);
  }
  /** Sums by the value of a label. */
  by(name: string, key: string): Record<string, number> {
    const sums: Record<string, number> = {};
    for (const { labels, value } of this.all(name)) {
      const of = labels[key] ?? "";
      sums[of] = (sums[of] ?? 0) + value;
    }
    return sums;
  }

  /** Histograms by the value of a label. */
  times(name: string, key: string): Record<string, Times> {
    const cumulative = new Map<string, Map<number, number>>();
    for (const { labels, value } of this.all(`${name}_bucket`)) {
      const of = labels[key] ?? "";
      const counts = cumulative.get(of) ?? new Map<number, number>();
      const bound = boundOf(labels["le"] ?? "");
      counts.set(bound, (counts.get(bound) ?? 0) + value);
      cumulative.set(of, counts);
    }
    const sums = this.by(`${name}_sum`, key);
    const times: Record<string, Times> = {};
    for (const [of, counts] of cumulative) {
      const bounds = [...counts.keys()].sort((a, b) => a - b);
      times[of] = {
        bounds: bounds.filter(Number.isFinite),
        counts: bounds.map((bound, i) => counts.get(bound)! - (counts.get(bounds[i - 1]!) ?? 0)),
        sum: sums[of] ?? 0,
        count: counts.get(Infinity) ?? 0,
      };
    }
    return times;
  }
}

function labelsOf(text: string): Record<string, string> {
  const labels: Record<string, string> = {};
  for (const [, name = "", value = ""] of text.matchAll(label)) {
    labels[name] = value.replace(/\\(.)/g, (_, c: string) => (c === "n" ? "\n" : c));
  }
  return labels;
}

const boundOf = (text: string): number => (text === "+Inf" ? Infinity : Number(text));
